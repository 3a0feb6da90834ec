#!/usr/bin/env bash
# economy.sh FOLDER: economy.csv there becomes order.svg, time.svg and table.md, large.csv,
# where it is there, large.md.
set -euo pipefail
cd "$1"
awk -F, 'NR > 1 {
  if ($1 != scene) { if (NR > 2) print "\n"; print "\"" $1 "\""; scene = $1 }
  print $5, $3, $6, $7 / $8, $9 / $10
}' economy.csv >economy.dat
scenes=$(awk -F, 'NR > 1 && !seen[$1]++' economy.csv | wc -l)
gnuplot <<PLOT
set terminal svg size 860,560 font "sans,15" background "white"
set monochrome
set logscale xy
set format x "10^{%T}"
set grid back linetype 1 linecolor rgb "#cccccc" dashtype solid linewidth 0.5
set border 3
set tics nomirror
set key outside right
set xlabel "bound of the error over the band"
set xrange [] reverse
set output "order.svg"
set ylabel "states"
plot for [i=0:$scenes-1] "economy.dat" index i using 1:2 with linespoints title columnheader(1), \
     for [i=0:$scenes-1] "economy.dat" index i using 1:(\$3 > 0 ? \$3 : NaN) with points \
       pointtype i+1 pointsize 0.5 notitle
set output "time.svg"
set ylabel "seconds, over the full system's"
plot for [i=0:$scenes-1] "economy.dat" index i using 1:4 with linespoints \
       title sprintf("transfer %d", i + 1), \
     for [i=0:$scenes-1] "economy.dat" index i using 1:5 with lines dashtype 2 \
       title sprintf("step %d", i + 1)
PLOT
awk -F, 'NR == 1 {
  print "| scene | asked | states | of | bound | plain truncation, states | transfer | of the full one | step | of the full one |"
  print "|---|---|---|---|---|---|---|---|---|---|"
  next
}
{ printf "| %s | %s | %d | %d | %s | %s | %s s | %.2g | %s s | %.2g |\n", $1, $2, $3, $4, $5,
         ($6 > 0 ? $6 : $6 < 0 ? "-" : "all"), $7, $7 / $8, $9, $9 / $10 }' economy.csv >table.md
rm economy.dat
[[ -e large.csv ]] || exit 0
awk -F, 'NR == 1 {
  print "| bodies | coordinates | asked | after bodies | what that cost | states | bound | all of it |"
  print "|---|---|---|---|---|---|---|---|"
  next
}
{ printf "| %s | %s | %s | %s | %s | %s | %s | %s s |\n", $1, $2, $3, $4, $5, $6, $7, $8 }' large.csv >large.md
