# gnuplot -e "data='F'; labels='F'; count=N; output='F.svg'; title=''; xlabel=''; ylabel=''" lines.gp
# notes='F': letters beside points; linear=1: along x; reverse=1: x falls to the
# right; names='"A" "B"': a key instead of names at the ends.
# Log-log lines in black and white: each has its own points and dashes and its name at its end.
set terminal svg size (exists("names") ? 1060 : 860),600 font "sans,15" background "white" enhanced
set output output
set monochrome
set datafile separator ","
set title title
set xlabel xlabel
set ylabel ylabel
if (exists("reverse")) {
  stats data using 1 nooutput
  if (exists("linear")) { set xrange [STATS_max + 0.5:STATS_min - 0.5] } else { set xrange [3 * STATS_max:STATS_min / 3] }
}
set logscale y
if (!exists("linear")) { set logscale x; set format x "10^{%T}" }
set format y "10^{%T}"
set grid back linetype 1 linecolor rgb "#cccccc" dashtype solid linewidth 0.5
set border 3
set tics nomirror
set rmargin 30
set offsets graph 0.02, graph 0.02, 0, 0
more = exists("notes") ? \
  ', notes using 1:2 with dots linecolor rgb "black" notitle' . \
  ', notes using 1:2:3 with labels offset 0,0.6 font ",11" noenhanced notitle' : ''
if (!exists("names")) more = ', labels using 1:2:3 with labels left offset 1,0 noenhanced notitle' . more
name(i) = exists("names") ? word(names, i) : ""
if (exists("names")) { set rmargin -1; set key outside right noenhanced }
array points[12] = [7, 4, 5, 6, 9, 8, 11, 10, 13, 12, 2, 1]
plot for [i=1:count] data index i-1 using 1:2 with linespoints linecolor rgb "black" \
       linewidth (i == 1 ? 2 : 1) dashtype i pointtype points[i] pointsize 0.8 title name(i) @more
