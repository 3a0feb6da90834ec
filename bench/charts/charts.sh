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
  labels_of "$data" >"$work/$1.labels"
  local count
  count=$(grep -c '^#' "$data")
  [[ -s $work/$1.labels ]] || return 0
  gnuplot -e "data='$data'; labels='$work/$1.labels'; count=$count; output='$out/$1.svg';
    title='$2'; xlabel='$3'; ylabel='$4'; ${5:-}" $here/lines.gp
}

# block NAME LABEL: stdin as one more line of chart NAME, unless it is empty.
block() {
  local points
  points=$(cat)
  [[ -z $points ]] || printf '# %s\n%s\n\n\n' "$2" "$points" >>"$work/$1.dat"
}

# The time of a task on a scene by all methods.
draw_task() {
  local name=$1 task=$2 scene=$3 title=$4 method
  rm -f "$work/$name.dat"
  for method in titop "titop all cores" "titop on one core" "titop descriptor" "sparse LU" "dense LU" "dense model" \
    "factorization alone" "memset of A"; do
    series "$out/times.csv" "$task" "$scene" "$method" | block "$name" "$method"
  done
  case $task in
    *compile | *factor)
      best_octave "$out/octave.csv" "$scene" '(names|append|mconnect|lft|dense matrices)$' |
        block "$name" "best of Octave with control"
      best_octave "$out/octave.csv" "$scene" 'sparse matrices$' |
        block "$name" "Octave sparse matrices"
      ;;
  esac
  chart "$name" "$title" "bodies" "seconds"
}

# Exponent of growth over all points of one column: least squares of logarithms.
slope() {
  awk -F, '{ x = log($1); y = log($2); n++; a += x; b += y; c += x * x; d += x * y }
    END { if (n > 1) printf "%.2f", (n * d - a * b) / (n * c - a * a) }'
}

draw_growth() {
  local name=$1 column=$2 title=$3 ylabel=$4 per=$5 scene points
  rm -f "$work/$name.dat"
  for scene in A BL C D K F; do
    points=$(awk -F, -v s=$scene -v c="$column" -v per="$per" \
      '$1 == s { v = c == "bytes" ? $9 + $10 : $c; print $2 "," v / (per ? $2 : 1) }' \
      "$out/growth.csv")
    [[ -z $points ]] || echo "$points" | block "$name" "$scene (slope $(echo "$points" | slope))"
  done
  chart "$name" "$title" "bodies" "$ylabel"
}

draw_accuracy() {
  local scene=$1 method
  rm -f "$work/accuracy-$scene.dat"
  awk -F, -v s="$scene" '$1 == s && !seen[$4]++ { print $4 }' "$out/accuracy.csv" |
    while read -r method; do
      awk -F, -v s="$scene" -v m="$method" \
        '$1 == s && $4 == m { print $3 "," ($5 < 1e-17 ? 1e-17 : $5) }' "$out/accuracy.csv" |
        block "accuracy-$scene" "$method"
    done
  chart "accuracy-$scene" "case $scene, ten bodies scaled by 10^k and 10^{-k} in turn" "k" \
    "largest relative error of the transfer" "linear=1"
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
  chart "work-precision-$scene$n" "case $scene, $n bodies: error against cost" "seconds of all steps" \
    "largest error of a state"
}

draw_all() {
  local scene
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
  for scene in A BL D; do draw_accuracy "$scene"; done
  draw_integration A 10
  draw_integration D 5
  [[ $mode == quick ]] || draw_integration D 50
}
