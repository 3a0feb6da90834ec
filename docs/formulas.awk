# For Doxygen, which knows no $$ on a line of its own, and one README.md only.
/^\$\$$/ {
  inside = !inside
  print inside ? "\\f[" : "\\f]"
  next
}
{
  gsub(/\]\([^)]*\/README\.md\)/, "]")
  print
}
