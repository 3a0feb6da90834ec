# A user's compile takes as long as <titop/titop.hpp> has to be read: 3 s. It includes Core and
# SparseCore of Eigen and the standard library, none of the libraries behind titop's own files, and no
# more headers than are listed here with some room.
execute_process(COMMAND ${CMAKE_COMMAND} -E echo "#include <titop/titop.hpp>"
                OUTPUT_FILE ${FOLDER}/includes.cpp)
execute_process(COMMAND ${COMPILER} -std=c++20 -I${INCLUDE} -isystem ${EIGEN} -M
                        ${FOLDER}/includes.cpp
                OUTPUT_VARIABLE files ERROR_VARIABLE text RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "titop.hpp is not read:\n${text}")
endif()
string(REGEX REPLACE "[ \\\n]+" ";" files "${files}")

set(wrong "")
foreach(rule "titop|97|/titop/" "Eigen|175|/eigen3/" "all|600|^/")
  string(REPLACE "|" ";" rule "${rule}")
  list(GET rule 0 name)
  list(GET rule 1 limit)
  list(GET rule 2 pattern)
  set(found ${files})
  list(FILTER found INCLUDE REGEX "${pattern}")
  list(LENGTH found count)
  message("${name}: ${count} files, limit ${limit}")
  if(count GREATER limit OR count EQUAL 0)
    string(APPEND wrong "\n  ${count} files of ${name}, limit ${limit}")
  endif()
endforeach()
foreach(pattern "/boost/" "/fmt/" "/nlohmann/" "/Eigen/src/(Eigenvalues|SVD|QR|LU|Cholesky|SparseLU)/"
                "/(iostream|regex)$")
  set(found ${files})
  list(FILTER found INCLUDE REGEX "${pattern}")
  if(found)
    list(GET found 0 first)
    string(APPEND wrong "\n  ${first}")
  endif()
endforeach()
if(wrong)
  message(FATAL_ERROR "titop.hpp includes too much:${wrong}")
endif()
