# Sourced by bench/run: the charts from the CSV files in $out.
# shellcheck shell=bash

here=bench/charts

# series FILE TASK SCENE METHOD: lines "n,seconds" of one method that agreed with titop.
series() {
  awk -F, -v t="$2" -v s="$3" -v m="$4" \
    '$1 == t && $2 == s && $4 == m && $5 != "" && $7 == "" { print $3 "," $5 }' "$1"
}

# best_octave FILE SCENE PATTERN: the fastest of Octave's ways whose names match, at each n.
best_octave() {
  awk -F, -v s="$2" -v p="$3" '
    $2 == s && $4 ~ p && $5 != "" && $7 == "" && (!($3 in best) || $5 < best[$3]) { best[$3] = $5 }
    END { for (n in best) print n "," best[n] }' "$1" | sort -g
}

# Names at the ends of the lines, moved apart where they would meet: by a twenty-fifth of the chart.
labels_of() {
  awk -F, -v OFS=, '
    /^#/ { name = substr($0, 3); next }
    NF == 2 {
      x[name] = $1; y[name] = $2
      if (low == "" || $2 < low) low = $2
      if ($2 > high) high = $2
    }
    END { for (n in x) print x[n], y[n], exp(log(high / low + 10) / 25), n }' "$1" |
    sort -t, -k1,1g -k2,2g |
    awk -F, -v OFS=, '
      $1 == last && $2 < y * $3 { $2 = y * $3 }
      { last = $1; y = $2; print $1, $2, $4 }'
}

# chart NAME TITLE XLABEL YLABEL: draws $work/NAME.dat, blocks of lines under "# name".
chart() {
  local data=$work/$1.dat
  [[ -s $data ]] || return 0
  labels_of "$data" >"$work/$1.labels"
  local count
  count=$(grep -c '^#' "$data")
  [[ -s $work/$1.labels ]] || return 0
  local notes=
  [[ ! -s $work/$1.notes ]] || notes="notes='$work/$1.notes';"
  gnuplot -e "data='$data'; labels='$work/$1.labels'; count=$count; output='$out/$1.svg';
    title='$2'; xlabel='$3'; ylabel='$4'; $notes ${5:-}" $here/lines.gp
}

# keyed NAME ...: the same with a key, where lines end at one another.
keyed() {
  [[ -s $work/$1.dat ]] || return 0
  chart "$@" "names='$(sed -n 's/^# \(.*\)/"\1"/p' "$work/$1.dat" | tr '\n' ' ')'"
}

# block NAME LABEL: stdin as one more line of chart NAME, unless it is empty.
block() {
  local points
  points=$(cat)
  [[ -z $points ]] || printf '# %s\n%s\n\n\n' "$2" "$points" >>"$work/$1.dat"
}

# timed NAME LABEL: a block with its slope over the last four points, past what small scenes cost.
timed() {
  local points order
  points=$(cat)
  order=$(echo "$points" | tail -n 4 | slope)
  [[ -z $points ]] || echo "$points" | block "$1" "$2${order:+ (slope $order)}"
}

# The time of a task on a scene by all methods.
draw_task() {
  local name=$1 task=$2 scene=$3 title=$4 method
  rm -f "$work/$name.dat"
  for method in titop "titop all cores" "titop on one core" "titop descriptor" "sparse LU" "dense LU" "dense model" \
    "factorization alone" "memset of A"; do
    series "$out/times.csv" "$task" "$scene" "$method" | timed "$name" "$method"
  done
  case $task in
    *compile | *factor)
      best_octave "$out/octave.csv" "$scene" '(names|append|mconnect|lft|dense matrices)$' |
        timed "$name" "best of Octave with control"
      best_octave "$out/octave.csv" "$scene" 'sparse matrices$' |
        timed "$name" "Octave sparse matrices"
      ;;
    sweep) series "$out/octave.csv" sweep "$scene" "Octave freqresp" | timed "$name" "Octave freqresp" ;;
  esac
  keyed "$name" "$title" "bodies" "seconds; slopes over the last four points"
}

# Exponent of growth over all points of one column: least squares of logarithms.
slope() {
  awk -F, '{ x = log($1); y = log($2); n++; a += x; b += y; c += x * x; d += x * y }
    END { if (n > 2) printf "%.2f", (n * d - a * b) / (n * c - a * a) }'
}

# The steeper of the slopes up to 1 and from 1 on: ratios and units go to both extremes.
steepest() {
  local points
  points=$(cat)
  { echo "$points" | awk -F, '$1 <= 1' | slope; echo; echo "$points" | awk -F, '$1 >= 1' | slope; } |
    awk 'NF { s = $1 < 0 ? -$1 : $1; if (best == "" || s > best) { best = s; found = $1 } } END { print found }'
}

draw_growth() {
  local name=$1 column=$2 title=$3 ylabel=$4 per=$5 scene points
  rm -f "$work/$name.dat"
  for scene in A BL C D K T CB F SL SG; do
    points=$(awk -F, -v s=$scene -v c="$column" -v per="$per" \
      '$1 == s { v = c == "bytes" ? $9 + $10 : $c; print $2 "," v / (per ? $2 : 1) }' \
      "$out/growth.csv")
    [[ -z $points ]] || echo "$points" | block "$name" "$scene (slope $(echo "$points" | slope))"
  done
  keyed "$name" "$title" "bodies" "$ylabel"
}

# One transfer: error against time, a line per method from float to 50 digits.
draw_precision() {
  local scene=$1 n=$2 method name=precision-$1
  rm -f "$work/$name.dat"
  for method in titop "titop dense model" "dense LU model" "sparse LU at s" "dense LU at s" \
    "block by block" tearing; do
    awk -F, -v s="$scene" -v m="$method" \
      '$1 == "transfer" && $2 == s && $4 == m && $6 > 0 && $5 != "as needed" {
        print $6 "," ($7 < 1e-17 ? 1e-17 : $7) }' "$out/accuracy.csv" | block "$name" "$method"
  done
  awk -F, -v OFS=, -v s="$scene" '$1 == "transfer" && $2 == s && $6 > 0 {
      print $6, ($7 < 1e-17 ? 1e-17 : $7), substr($5, 1, 1) == "5" ? "50" : substr($5, 1, 1) }' \
    "$out/accuracy.csv" >"$work/$name.notes"
  keyed "$name" "case $scene ($n bodies): one transfer" \
    "seconds; f: float, d: double, r: refined, t: twofold, l: long double, a: as needed" "largest relative error"
}

# 100 frequencies from the compiled system on.
draw_response() {
  local method name=response-D n
  rm -f "$work/$name.dat" "$work/$name.notes"
  for n in 2 10 50; do
    for method in titop "dense model and LU" "dense model and Hessenberg"; do
      awk -F, -v n="$n" -v m="$method" '$1 == "response" && $3 == n && $4 == m && $5 != "as needed" {
        print $6 "," $7 }' "$out/accuracy.csv" | block "$name" "$method ($n)"
    done
  done
  awk -F, -v OFS=, '$1 == "response" && $4 == "titop" { print $6, $7, substr($5, 1, 1) }' \
    "$out/accuracy.csv" >"$work/$name.notes"
  keyed "$name" "case D (2 and 10 and 50 bodies): 100 frequencies" \
    "seconds; f: float, d: double, r: refined, t: twofold, a: as needed" "largest relative error"
}

# Error of every method while one quantity goes to an extreme, with the steepest slope; rings where the library warns or
# notes something, crosses where it refuses.
draw_failures() {
  local name=failure-$1 method title quantity options points order
  title=$(awk -F, -v s="$1" '$1 == s { print $2; exit }' "$out/failures.csv")
  quantity=$(awk -F, -v s="$1" '$1 == s { print $3; exit }' "$out/failures.csv")
  rm -f "$work/$name.dat"
  for method in titop "titop in double" "titop dense model" "dense LU" "sparse LU at s" \
    "block by block" tearing "last place of the data"; do
    points=$(awk -F, -v s="$1" -v m="$method" '
      $1 == s && $5 == m && ($7 == "" || $7 == "warned" || $7 == "noted") {
        print $4 "," ($6 < 1e-17 ? 1e-17 : $6) }' "$out/failures.csv")
    order=$(echo "$points" | awk -F, '$2 > 3e-14 && $2 < 0.1' | steepest)
    [[ $1 != digits ]] || order=
    [[ -z $points ]] || echo "$points" | block "$name" "$method${order:+ (slope $order)}"
  done
  awk -F, -v OFS=, -v s="$1" '$1 == s && $7 != "" && $5 != "titop in double" {
      print $4, ($6 < 1e-17 ? 1e-17 : $6), $7 == "warned" || $7 == "noted" ? "o" : "x" }' \
    "$out/failures.csv" >"$work/$name.notes"
  options=$(awk -F, -v s="$1" '$1 == s { if (first == "") first = $4; last = $4 }
    END { print (first > last ? "reverse=1;" : "") (first < 100 && last < 100 && last > 1 ? "linear=1;" : "") }' \
    "$out/failures.csv")
  chart "$name" "$title" "$quantity" "largest relative error (o: said in the log; x: refused)" "$options"
}

# Energy of an undamped structure, and the gap of a closed chain, over steps.
draw_drift() {
  local test=$1 scene=$2 name=$3 title=$4 ylabel=$5 method points order
  rm -f "$work/$name.dat"
  awk -F, -v t="$test" -v s="$scene" '$1 == t && $2 == s && !seen[$3]++ { print $3 }' "$out/drift.csv" |
    while read -r method; do
      points=$(awk -F, -v t="$test" -v s="$scene" -v m="$method" '
        $1 == t && $2 == s && $3 == m && $5 < 1e6 { print $4 "," ($5 < 1e-17 ? 1e-17 : $5) }' "$out/drift.csv")
      order=$(echo "$points" | awk -F, '$2 > 1e-14' | slope)
      echo "$points" | block "$name" "$method${order:+ (slope $order)}"
    done
  [[ $test != energy ]] || awk -F, -v s="$scene" '$1 == "energy" && $2 == s && $3 == "midpoint" {
    print $4 "," $6 }' "$out/drift.csv" | block "$name" "bound: steps states 2^-53"
  chart "$name" "$title" "steps" "$ylabel"
}

# Growth per step, as measured; bench_drift has found it equal to theory.
draw_growth_factors() {
  local name=stability method
  rm -f "$work/$name.dat"
  awk -F, '$1 == "growth" && !seen[$3]++ { print $3 }' "$out/drift.csv" | while read -r method; do
    awk -F, -v m="$method" '$1 == "growth" && $3 == m && $5 < 20 { print $4 "," $5 }' \
      "$out/drift.csv" | block "$name" "$method"
  done
  chart "$name" "growth per step of an undamped mass" "step times frequency" "growth per step"
}

# Error of time integration against step and against seconds; the slope over what is neither rounding
# nor a failure.
draw_integration() {
  local scene=$1 n=$2 method points order
  rm -f "$work/integration-$scene$n".dat "$work/work-precision-$scene$n".dat
  for method in exact midpoint Newmark rk4 "rk4 unguarded" "explicit Euler"; do
    points=$(awk -F, -v s="$scene" -v n="$n" -v m="$method" '
      $1 == s && $2 == n && $3 == m && $5 < 1e3 { print $4 "," ($5 < 1e-16 ? 1e-16 : $5) "," $6 }' \
      "$out/integration.csv")
    order=$(echo "$points" | awk -F, '$2 > 1e-10 && $2 < 1e-2' | slope)
    echo "$points" | cut -d, -f1,2 | block "integration-$scene$n" "$method${order:+ (slope $order)}"
    echo "$points" | awk -F, 'NF { print $3 "," $2 }' | sort -g |
      block "work-precision-$scene$n" "$method"
  done
  chart "integration-$scene$n" "case $scene, $n bodies: error of time integration" \
    "step times fastest frequency" "largest error of a state"
  keyed "work-precision-$scene$n" "case $scene, $n bodies: error against cost" "seconds of all steps" \
    "largest error of a state"
}

# Derivative of a transfer by a parameter: error against the step of differences, with their time.
draw_derivatives() {
  local name=derivatives way points order milliseconds
  [[ -s $out/derivatives.csv ]] || return 0
  rm -f "$work/$name.dat"
  for way in exact "differences in double" "differences in 50 digits"; do
    points=$(awk -F, -v w="$way" '$1 == w { print $2 "," ($3 < 1e-17 ? 1e-17 : $3) }' "$out/derivatives.csv")
    milliseconds=$(awk -F, -v w="$way" '$1 == w && (best == "" || $4 < best) { best = $4 }
      END { printf "%.2g", 1e3 * best }' "$out/derivatives.csv")
    echo "$points" | block "$name" "$way ($milliseconds ms)"
  done
  keyed "$name" "derivative of a transfer by the tilt of two wings" "step [rad]" "relative error"
}

# Finite models of distributed bodies: error over states, and brackets over shapes.
draw_distributed() {
  local chart=$1 name=$2 title=$3 xlabel=$4 ylabel=$5 options=${6:-} series
  [[ -s $out/distributed.csv ]] || return 0
  rm -f "$work/$name.dat"
  awk -F, -v c="$chart" '$1 == c && !seen[$2]++ { print $2 }' "$out/distributed.csv" |
    while read -r series; do
      awk -F, -v c="$chart" -v s="$series" '$1 == c && $2 == s { print $3 "," $4 }' \
        "$out/distributed.csv" | block "$name" "$series"
    done
  chart "$name" "$title" "$xlabel" "$ylabel" "$options"
}

draw_all() {
  local scene n
  for scene in D F K A BL C; do
    draw_task "compile-$scene" compile "$scene" "case $scene: from Diagram to dense model"
    draw_task "recompile-$scene" recompile "$scene" "case $scene: new values to dense model"
    draw_task "factor-$scene" factor "$scene" "case $scene: from Diagram to factors and one product"
    draw_task "refactor-$scene" refactor "$scene" "case $scene: new values to factors and one product"
  done
  for scene in D A; do
    draw_task "sweep-$scene" sweep "$scene" "case $scene: transfer at 100 frequencies"
    draw_task "apply-$scene" apply "$scene" "case $scene: one product"
  done
  draw_growth growth-compile 5 "first compile, no dense model" "seconds" ""
  draw_growth growth-memory bytes "memory of Diagram and System" "bytes per body" per
  while IFS=, read -r scene n; do draw_precision "$scene" "$n"; done < <(
    awk -F, '$1 == "transfer" && !seen[$2]++ { print $2 "," $3 }' "$out/accuracy.csv")
  draw_response
  while read -r scene; do draw_failures "$scene"; done < <(
    awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' "$out/failures.csv")
  draw_drift energy "five masses" energy-five-masses "five masses without damping" "change of energy"
  draw_drift energy satellite energy-satellite "the satellite without damping" "change of energy"
  draw_drift energy "1000 masses" energy-1000-masses "1000 masses in a row without damping" \
    "change of energy"
  draw_drift closure "six masses" closure "six masses between two walls: does the chain stay closed?" \
    "gap over the largest stretch"
  draw_growth_factors
  draw_derivatives
  draw_distributed arm distributed-arm "two links on a hub, 0 to 50 Hz" "states" \
    "error against the distributed beams" "linear=1;"
  draw_distributed plates distributed-plates "two halves of a plate, welded along the cut" \
    "polynomials of displacement and slope each" "width of the bracket over the frequency" "linear=1;"
  draw_integration A 10
  draw_integration D 5
  [[ $mode == quick ]] || draw_integration D 50
}
