#!/usr/bin/env bash
# reduction.sh FOLDER: reduction.csv there becomes order.svg, time.svg, simulation.svg and table.md,
# simulation.md, rules.md; large.csv, where it is there, large.md.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$1"

# A block per scene, a line per accuracy; rows of rules are none.
awk -F, 'NR > 1 && $2 + 0 > 0 {
  if ($1 != scene) { if (scene != "") print "\n"; print "\"" $1 "\""; scene = $1 }
  print $6, $3, $7 / $8, $12 / $14, $17,
        ($9 == "" ? "NaN NaN NaN" : $10 " " $9 " " $11 / $8)
}' reduction.csv >reduction.dat
trap 'rm -f reduction.dat' EXIT
gnuplot -e "scenes=$(grep -c '^"' reduction.dat)" "$here/reduction.gp"

awk -F, 'NR == 1 {
  print "| scene | asked | states | of | bound | error | bound / error | transfer | of the full one | plain truncation, states | over ours | its transfer | over ours |"
  print "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
  next
}
$2 + 0 > 0 {
  printf "| %s | %s | %d | %d | %s | %s | %.2f | %s s | %.2g |", $1, $2, $3, $4, $5, $6, $5 / $6, $7, $7 / $8
  if ($9 == "") print " - | - | - | - |"
  else printf " %s | %.1f | %s s | %.1f |\n", ($9 == $4 ? "all, " $9 : $9), $9 / $3, $11, $11 / $7
}' reduction.csv >table.md

awk -F, 'NR == 1 {
  print "| scene | asked | states | simulation | to start | full one | to start | ours over full | difference | error, same rule |"
  print "|---|---|---|---|---|---|---|---|---|---|"
  next
}
$2 + 0 > 0 {
  printf "| %s | %s | %d | %s s | %s s | %s s | %s s | %.2g | %s | %s |\n",
         $1, $2, $3, $12, $13, $14, $15, $12 / $14, $16, $17
}' reduction.csv >simulation.md

awk -F, 'NR == 1 {
  print "| scene | modes kept | states | of | error | transfer | of the full one |"
  print "|---|---|---|---|---|---|---|"
  next
}
$2 + 0 == 0 {
  printf "| %s | %s | %d | %d | %s | %s s | %.2g |\n",
         $1, ($2 == "bodies" ? "of each body" : "of the whole"), $3, $4, $6, $7, $7 / $8
}' reduction.csv >rules.md

[[ -e large.csv ]] || exit 0
awk -F, 'NR == 1 {
  print "| bodies | coordinates | accuracy | coordinates after reduction of bodies | its error | states | bound | time |"
  print "|---|---|---|---|---|---|---|---|"
  next
}
{ printf "| %s | %s | %s | %s | %s | %s | %s | %s s |\n", $1, $2, $3, $4, $5, $6, $7, $8 }' large.csv >large.md
