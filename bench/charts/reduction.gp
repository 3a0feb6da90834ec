# gnuplot -e "scenes=N" reduction.gp: reduction.dat of reduction.sh to order.svg, time.svg, simulation.svg.
# In black and white: a scene is a kind of mark, filled and solid for the small model, open and
# dashed for plain truncation.
set terminal svg size 900,560 font "sans,15" background "white"
set monochrome
set logscale xy
set format "10^{%T}"
set grid back linetype 1 linecolor rgb "#cccccc" dashtype solid linewidth 0.5
set border 3
set tics nomirror
set key outside right noenhanced
set offsets 0, 0, graph 0.05, graph 0.05
set xlabel "largest error over the band"
set xrange [0.3:1e-9]
set autoscale yfix
array filled[6] = [7, 5, 9, 11, 13, 15]
array open[6] = [6, 4, 8, 10, 12, 14]

set output "order.svg"
set ylabel "states"
plot for [i=1:scenes] "reduction.dat" index i-1 using 1:2 with linespoints linecolor rgb "black" \
       linewidth 1.5 dashtype solid pointtype filled[i] pointsize 0.8 title columnheader(1), \
     for [i=1:scenes] "reduction.dat" index i-1 using 6:7 with linespoints linecolor rgb "black" \
       linewidth 0.7 dashtype 2 pointtype open[i] pointsize 0.8 notitle, \
     keyentry with linespoints linecolor rgb "black" linewidth 0.7 dashtype 2 pointtype 6 \
       title "plain truncation"

set output "time.svg"
set ylabel "seconds of a transfer, over the full system's"
plot for [i=1:scenes] "reduction.dat" index i-1 using 1:3 with linespoints linecolor rgb "black" \
       linewidth 1.5 dashtype solid pointtype filled[i] pointsize 0.8 title columnheader(1), \
     for [i=1:scenes] "reduction.dat" index i-1 using 6:8 with linespoints linecolor rgb "black" \
       linewidth 0.7 dashtype 2 pointtype open[i] pointsize 0.8 notitle, \
     keyentry with linespoints linecolor rgb "black" linewidth 0.7 dashtype 2 pointtype 6 \
       title "plain truncation"

set output "simulation.svg"
set xlabel "largest error of an output in time, over its largest value"
set autoscale x
set xrange [] reverse
set yrange [1e-3:1]
set ylabel "seconds of a simulation, over the full system's"
plot for [i=1:scenes] "reduction.dat" index i-1 using 5:4 with linespoints linecolor rgb "black" \
       linewidth 1.5 dashtype solid pointtype filled[i] pointsize 0.8 title columnheader(1)
