# For Doxygen, which knows no $$ on a line of its own.
/^\$\$$/ {
  inside = !inside
  print inside ? "\\f[" : "\\f]"
  next
}
{ print }
