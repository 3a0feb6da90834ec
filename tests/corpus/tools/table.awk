# Counts of build/corpus/octave.tsv: scenes with an answer by what was made of them, and orders.
$6 >= 0 {
  ++scenes
  ++verdict[$2]
  if ($2 == "right") {
    if ($4 == $6) ++order["as it is"]
    else if ($5 == $6) ++order["after minreal"]
    else ++order["not even after minreal"]
  }
  next
}
{ ++mistakes; ++noticed[$2] }
END {
  print "| scenes with an answer | " scenes + 0 " |"
  print "|---|---|"
  print "| transfer right to 1e-6 | " verdict["right"] + 0 " |"
  print "| transfer wrong | " verdict["wrong"] + 0 " |"
  print "| refused | " verdict["refused"] + 0 " |"
  print "| of the right ones: order right as it is | " order["as it is"] + 0 " |"
  print "| order right after `minreal` | " order["after minreal"] + 0 " |"
  print "| order wrong even then | " order["not even after minreal"] + 0 " |"
  print ""
  print "| planted mistakes that can be written down at all | " mistakes + 0 " |"
  print "|---|---|"
  print "| refused | " noticed["refused"] + 0 " |"
  print "| answered with a model | " noticed["answered"] + 0 " |"
}
