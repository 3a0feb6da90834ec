# docs/bench/measured.md from times.csv, octave.csv, growth.csv, accuracy.csv, failures.csv and
# drift.csv.

FNR == 1 { file = FILENAME; sub(/.*\//, "", file); next }
file == "times.csv" || file == "octave.csv" {
  if ($5 == "") next
  key = $1 SUBSEP $2 SUBSEP $3 SUBSEP $4
  seconds[key] = $5
  if ($7 != "") marked[key] = $7
  if ($6 > worst[$4]) worst[$4] = $6
}
file == "octave.csv" && $1 == "compile" && $5 != "" && $7 == "" { note_octave($2 SUBSEP $3, $4, $5) }
file == "growth.csv" {
  if (!($1 in points)) scenes[++scene_count] = $1
  k = ++points[$1]
  bodies[$1, k] = $2; built[$1, k] = $4; compiled[$1, k] = $5; answered[$1, k] = $6
  changed[$1, k] = $7; bytes[$1, k] = $9 + $10; peak[$1, k] = $11; again[$1, k] = $12
}
file == "accuracy.csv" {
  key = $1 SUBSEP $4 SUBSEP $5
  if (!(key in met)) { met[key] = 1; method[++method_count] = key }
  if (!(($1, $2, $3) in case_met)) { case_met[$1, $2, $3] = 1; cases[$1] = cases[$1] " " $2 "/" $3 }
  error[key, $2, $3] = $7; cost[key, $2, $3] = $6
}
file == "failures.csv" {
  if (!($1 in sweep_met)) { sweep_met[$1] = 1; sweep[++sweep_count] = $1; about[$1] = $2 }
  if (!($5 in line_met)) { line_met[$5] = 1; line[++line_count] = $5 }
  if ($7 == "" || $7 == "noted") {
    if (!(($1, $5) in worst_error) || $6 > worst_error[$1, $5]) {
      worst_error[$1, $5] = $6; worst_at[$1, $5] = $4
    }
  } else told[$1, $5] = told[$1, $5] (told[$1, $5] == "" ? "" : " ") $4 ":" $7
}
file == "drift.csv" && $1 == "limit" { limits[++limit_count] = $3 "," $4 "," $5 "," $6 }

# The fastest of all ways, and of kinds of them: by hand with dense or sparse matrices, or with the
# control package, by matrices (mconnect, append, lft) or from named signals, as a diagram has them.
function note_octave(point, name, s) {
  if (name ~ /reference/) {
    if (name !~ /sparse/) least(point, "reference", name, s)
    return
  }
  if (name !~ /sparse/) least(point, "best", name, s)
  least(point, name ~ /sparse/ ? "sparse" : name ~ /dense/ ? "dense" : name ~ /names/ ? "names" : "package", name, s)
}
function least(point, kind, name, s) {
  if ((point, kind) in octave_best && s >= octave_best[point, kind]) return
  octave_best[point, kind] = s
  sub(/^Octave /, "", name)
  octave_way[point, kind] = name
}

function time(s) {
  if (s == "") return "-"
  return s < 1e-3 ? sprintf("%.3g µs", 1e6 * s) : s < 1 ? sprintf("%.3g ms", 1e3 * s) : sprintf("%.3g s", s)
}
function ratio(a, b) { return a == "" || b == "" ? "-" : sprintf("%.3g", a / b) }
function get(task, scene, n, name,   key) {
  key = task SUBSEP scene SUBSEP n SUBSEP name
  return key in seconds ? seconds[key] : ""
}
function mark(task, scene, n, name) {
  return (task, scene, n, name) in marked ? " (" marked[task, scene, n, name] ")" : ""
}
function octave_time(scene, n, kind) {
  return (scene SUBSEP n SUBSEP kind) in octave_best ? octave_best[scene SUBSEP n, kind] : ""
}

function row(task, scene, n, aim,   t, o, l, d) {
  t = get(task, scene, n, "titop")
  d = get(task, scene, n, "titop descriptor")
  if (t == "") return
  o = octave_time(scene, n, "best")
  l = get(task, scene, n, "sparse LU")
  printf "| %s | %s%s%s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s |\n", scene " " n, time(t), \
    mark(task, scene, n, "titop"), d == "" ? "" : " (descriptor " time(d) ")", time(o), octave_way[scene SUBSEP n, "best"], ratio(o, t), \
    ratio(octave_time(scene, n, "reference"), t), ratio(octave_time(scene, n, "sparse"), t), \
    ratio(octave_time(scene, n, "package"), t), ratio(octave_time(scene, n, "names"), t), \
    time(l) mark(task, scene, n, "sparse LU"), ratio(l, t), \
    ratio(get("compile", scene, n, "dense LU"), t), \
    ratio(t, get(task ~ /factor/ ? "factor" : "compile", scene, n, \
                 task ~ /factor/ ? "factorization alone" : "memset of A")), aim
}
function head(title, floor) {
  printf "\n## %s\n\n", title
  print "| case | titop | Octave | its best way | ratio | ... reference BLAS | ... sparse matrices | ... control package | ... by names | sparse LU | ratio | dense LU ratio | titop over " floor " | aim |"
  print "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
}

function slope(scene, column,   i, n, x, y, a, b, c, d) {
  for (i = 1; i <= points[scene]; ++i) {
    if (bodies[scene, i] < 1000 && bodies[scene, points[scene]] > 1000) continue
    if (column == "again" && again[scene, i] == "") continue
    x = log(bodies[scene, i])
    y = log(column == "compile" ? compiled[scene, i] : column == "again" ? again[scene, i] : bytes[scene, i])
    ++n; a += x; b += y; c += x * x; d += x * y
  }
  return n > 1 ? sprintf("%.2f", (n * d - a * b) / (n * c - a * a)) : "-"
}
function growth_row(scene,   k) {
  k = points[scene]
  printf "| %s | %d to %d | %s | %s | %s | %s | %s | %s | %s | %s | %.0f | %.0f |\n", scene, \
    bodies[scene, 1], bodies[scene, k], time(built[scene, k]), time(compiled[scene, k]), \
    slope(scene, "compile"), time(again[scene, k]), slope(scene, "again"), \
    time(answered[scene, k]), time(changed[scene, k]), \
    slope(scene, "bytes"), bytes[scene, k] / bodies[scene, k], peak[scene, k] / bodies[scene, k]
}

function change_row(scene, n,   one, all, whole) {
  one = get("change one", scene, n, "titop")
  all = get("change all", scene, n, "titop")
  whole = get("whole", scene, n, "titop")
  if (one == "") return
  printf "| %s %d | %s | %s | %s | %s | %.2g %% | %.2g %% |\n", scene, n, \
    time(get("diagram", scene, n, "titop")), time(whole), time(all), time(one), \
    100 * one / all, 100 * one / whole
}

function minimize_row(scene, n,   t) {
  t = get("minimize", scene, n, "titop")
  if (t != "") printf "| %s %d | %s%s | %s |\n", scene, n, time(t), mark("minimize", scene, n, "titop"), \
    ratio(t, get("compile", scene, n, "titop"))
}

function response_row(task, scene, n,   t) {
  t = get(task, scene, n, "titop")
  if (t == "") return
  printf "| %s %s %d | %s | %s | %s | %s | %s | %s | %s | %s |\n", task, scene, n, time(t), \
    time(get(task, scene, n, "titop all cores")), time(get(task, scene, n, "sparse LU")), \
    ratio(get(task, scene, n, "sparse LU"), t), time(get(task, scene, n, "dense model")), \
    ratio(get(task, scene, n, "dense model"), t), time(get(task, scene, n, "Octave freqresp")), \
    ratio(get(task, scene, n, "Octave freqresp"), t)
}

function accuracy_table(task, title,   i, m, k, part, list, n) {
  print "\n## " title "\n"
  n = split(cases[task], list, " ")
  printf "| method | precision |"
  for (i = 1; i <= n; ++i) { sub("/", " ", list[i]); printf " %s |", list[i] }
  printf "\n|---|---|"
  for (i = 1; i <= n; ++i) printf "---|"
  print ""
  for (m = 1; m <= method_count; ++m) {
    split(method[m], part, SUBSEP)
    if (part[1] != task) continue
    printf "| %s | %s |", part[2], part[3]
    for (i = 1; i <= n; ++i) {
      split(list[i], k, " ")
      if ((method[m], k[1], k[2]) in error)
        printf " %s (%s) |", error[method[m], k[1], k[2]], time(cost[method[m], k[1], k[2]])
      else printf " - |"
    }
    print ""
  }
}

function range_told(text,   list, n, first, last) {
  n = split(text, list, " ")
  if (n == 0) return ""
  split(list[1], first, ":"); split(list[n], last, ":")
  return "; " (n == 1 ? first[2] " at " first[1] : first[2] " ... " last[2] " at " first[1] " ... " last[1])
}
function failure_table(   i, m) {
  print "\n## Where methods break\n"
  print "Largest error over the sweep among the points at which nothing was said (@ where), and where" \
    " the library warned or refused.\n"
  printf "| sweep |"
  for (m = 1; m <= line_count; ++m) printf " %s |", line[m]
  printf "\n|---|"
  for (m = 1; m <= line_count; ++m) printf "---|"
  print ""
  for (i = 1; i <= sweep_count; ++i) {
    printf "| %s |", about[sweep[i]]
    for (m = 1; m <= line_count; ++m)
      printf " %s%s |", (sweep[i], line[m]) in worst_error \
        ? worst_error[sweep[i], line[m]] " @ " worst_at[sweep[i], line[m]] : "-", \
        range_told(told[sweep[i], line[m]])
    print ""
  }
}
function limit_table(   i, part) {
  print "\n## Limits of stability\n"
  print "Largest step times frequency of a mass with this damping ratio: measured by stepping, and by" \
    " the rule\047s factor.\n"
  print "| rule | damping ratio | measured | theory |\n|---|---|---|---|"
  for (i = 1; i <= limit_count; ++i) {
    split(limits[i], part, ",")
    printf "| %s | %s | %s | %s |\n", part[1], part[2], part[3], part[4]
  }
}

END {
  print "# Measured\n"
  print "Written by `bench/run`, read in [README.md](README.md); in one run on " cpu ", " cores \
    " cores, " when ", " compiler ", Octave " octave " with OpenBLAS. Each time is that of the" \
    " fastest run. titop starts from a built Diagram; the others get the scene as matrices, free of" \
    " charge: blocks, u = K y + E w, z = F y + G w, free channels inverted beforehand; of R and G," \
    " where chains close, mass, damping, stiffness and constraints of all bodies and joints."
  head("First compile, to the dense model in a warm buffer", "memset of A")
  row("compile", "D", 1, ""); row("compile", "D", 10, "Octave 20"); row("compile", "D", 50, "Octave 80")
  row("compile", "D", 100, ""); row("compile", "D", 200, "Octave 200"); row("compile", "D", 500, "")
  row("compile", "F", 10, ""); row("compile", "F", 50, ""); row("compile", "K", 10, ""); row("compile", "K", 50, "")
  row("compile", "A", 100, ""); row("compile", "A", 1000, "")
  head("Recompile with new values of all bodies, to the dense model", "memset of A")
  row("recompile", "D", 1, "Octave 30"); row("recompile", "D", 10, "Octave 100")
  row("recompile", "D", 50, "Octave 400"); row("recompile", "D", 200, "Octave 600, sparse LU 20")
  head("First compile, to factors and one product by them", "one sparse factorization")
  row("factor", "A", 100, "Octave 100"); row("factor", "A", 1000, "Octave 1000")
  row("factor", "BL", 100, ""); row("factor", "BL", 1000, ""); row("factor", "C", 100, ""); row("factor", "C", 1000, "")
  row("factor", "D", 50, ""); row("factor", "D", 200, ""); row("factor", "A", 100000, ""); row("factor", "BL", 100000, "")
  row("factor", "C", 100000, "")
  head("Recompile with new values of all bodies, to factors and one product", "one sparse factorization")
  row("refactor", "A", 100, "Octave 1000"); row("refactor", "A", 1000, "Octave 1000")
  row("refactor", "BL", 100, "Octave 1000"); row("refactor", "BL", 1000, "Octave 1000")
  row("refactor", "C", 100, "Octave 1000"); row("refactor", "C", 1000, "Octave 1000")
  row("refactor", "D", 50, ""); row("refactor", "D", 200, ""); row("refactor", "A", 100000, "")

  print "\n## The step by effect (`minimize`), of the dense model that compile writes\n"
  print "Minimization, which the times of compile above do not contain: it removes states that no input moves or no output sees.\n"
  print "| case | minimize | over compile |\n|---|---|---|"
  split("D F K A BL C", list, " ")
  for (i = 1; i <= 6; ++i) { minimize_row(list[i], 10); minimize_row(list[i], i < 4 ? 20 : 100) }

  print "\n## Changes, without a dense model\n"
  print "T is a balanced binary tree; \"all\" changes every body's angle or mass on the same plan.\n"
  print "| case | Diagram alone | compile | all changed | one changed | one over all | one over compile |"
  print "|---|---|---|---|---|---|---|"
  split("T D K C A BL", list, " ")
  for (i = 1; i <= 6; ++i) change_row(list[i], 1000)
  change_row("F", 100)

  print "\n## Responses\n"
  print "| task | titop | on all cores | sparse LU | ratio | dense model | ratio | Octave freqresp | ratio |"
  print "|---|---|---|---|---|---|---|---|---|"
  split("transfer sweep apply", list, " ")
  for (i = 1; i <= 3; ++i) {
    response_row(list[i], "D", 10); response_row(list[i], "D", 50); response_row(list[i], "D", 200); response_row(list[i], "D", 1000)
    response_row(list[i], "K", 200); response_row(list[i], "A", 1000); response_row(list[i], "A", 10000)
    response_row(list[i], "BL", 1000)
  }

  print "\n## Growth, a process per point\n"
  print "Times and bytes at the largest size. Aim: slopes of at most 1.1. The first compile (but for one of ten " \
    "bodies) has fresh memory; to compile again, small scenes have memory that the process holds and in part the " \
    "processor's caches.\n"
  print "| case | bodies | Diagram | first compile | slope | again | slope | transfer | one changed | slope of memory | bytes per body | peak per body |"
  print "|---|---|---|---|---|---|---|---|---|---|---|---|"
  for (i = 1; i <= scene_count; ++i) growth_row(scenes[i])

  accuracy_table("transfer", "One transfer: error against 150 digits (time)")
  accuracy_table("response", "100 frequencies from the compiled system on: error against 50 digits (time)")
  failure_table()
  limit_table()

  print "\n## Agreement\n"
  print "Largest relative difference from titop's result (entries over their row's largest), over all" \
    " points of a method; a point beyond 1e-6 is marked and left out of charts.\n"
  print "| method | worst |\n|---|---|"
  fflush()
  for (name in worst) print "| " name " | " worst[name] " |" | "sort"
  close("sort")
}
