# The rooms of the library and of its generator of scenes, lowest first: room(NAME MAY_INCLUDE...),
# beside itself and graph. Rooms that may be included stand above, so there is no cycle.
# docs/architecture.md has the same table.
# Only graph/linalg includes decompositions of Eigen, or LAPACK.
cmake_policy(VERSION 3.25)
set(wrong "")
set(names)
function(room name)
  foreach(other ${ARGN})
    if(NOT other IN_LIST names)
      message(FATAL_ERROR "${name} may not include ${other}, which is not above it in the table")
    endif()
  endforeach()
  set(names ${names} ${name} PARENT_SCOPE)
  set("allowed ${name}" ${ARGN} PARENT_SCOPE)
endfunction()
room(graph)
room(blocks/fe)
room(blocks                    blocks/fe)
room(blocks/diagram_file       blocks/fe blocks)
room(compiler/passes)
room(compiler/diagram          compiler/passes)
room(compiler/definition)
room(compiler/solve            compiler/passes compiler/definition)
room(compiler/loops            compiler/passes compiler/solve)
room(compiler/realization      compiler/solve)
room(compiler/certificate      compiler/definition compiler/solve)
room(compiler/index_reduction  compiler/solve compiler/loops)
room(compiler/minreal          compiler/passes compiler/definition compiler/solve
                               compiler/realization compiler/certificate)
room(compiler/system           compiler/passes compiler/diagram compiler/definition compiler/solve
                               compiler/loops compiler/realization compiler/certificate
                               compiler/index_reduction compiler/minreal)
# Deeper than System: the implicit midpoint rule and its error estimate use the factors of
# compiler/solve.
room(analysis/simulation       compiler/solve compiler/system)
room(analysis/sweep            compiler/system)
# Deeper than System: its oracles use the graph's structure, the definition, and the rounding of
# each entry.
room(analysis/certify          compiler/passes compiler/definition compiler/certificate
                               compiler/minreal compiler/system)
room(analysis/reduction        compiler/passes compiler/system)
# Above blocks: it makes bodies of parts of a scene.
room(analysis/damping          blocks compiler/system analysis/reduction)
room(analysis/bracket          compiler/system)
# Above blocks: it divides distributed beams into elements.
room(analysis/distributed      blocks compiler/system analysis/reduction)
room(analysis/norms)
# Deeper than System: it cuts the graph of a stage at loop points, and takes poles at 0 exactly.
room(analysis/control          compiler/passes compiler/minreal compiler/system analysis/norms
                               analysis/simulation analysis/reduction)
# Deeper than System: places of points follow from equations between accelerations.
room(analysis/shapes           compiler/loops compiler/system)
# Deeper than System: it opens parameters, and counts occurrences in exact arithmetic.
room(analysis/lft              compiler/passes compiler/definition compiler/system analysis/norms
                               analysis/reduction)
room(emit/text)
# Deeper than System: names of any encoding are cleaned by compiler/diagram.
room(emit/files                compiler/diagram compiler/system analysis/certify analysis/lft
                               emit/text)
# Deeper than System: it writes the modes of the second-order form.
room(emit/cpp                  compiler/realization compiler/system analysis/simulation
                               analysis/certify emit/text)
# Deeper than System: it draws System::stage(), a type of compiler/passes.
room(emit/report               compiler/passes compiler/diagram compiler/system analysis/simulation
                               analysis/certify analysis/reduction analysis/control analysis/shapes
                               analysis/bracket emit/text)
# Exact scenes have answers that the library has no part in.
room(app/generate              emit/text)
room(app/generate/diagrams     blocks/fe blocks app/generate)

# Headers with the data behind System: internal(HEADER USER...), the only files or folders outside of
# its room that may include it.
set(headers)
function(internal header)
  set(headers ${headers} ${header} PARENT_SCOPE)
  set("users ${header}" ${ARGN} PARENT_SCOPE)
endfunction()
# analysis/certify/certify_full.cpp reads the rounding of entries by the factors.
# analysis/reduction/coordinates.hpp reads bodies' modes and stiffnesses.
# analysis/reduction/reach_of_data.hpp reads bodies' modes. analysis/simulation/simulate.cpp takes
# the factors of a System.
internal(compiler/system/system_data.hpp analysis/certify/certify_full.cpp
         analysis/reduction/coordinates.hpp analysis/reduction/reach_of_data.hpp
         analysis/simulation/simulate.cpp)
# analysis/reduction/ compiles diagrams that it has rewritten, analysis/lft/ opened ones,
# analysis/damping/ parts of them, analysis/control/ diagrams cut at loop points,
# analysis/distributed/ those with finite beams, analysis/shapes/ those with all points as outputs.
internal(compiler/system/compile_graph.hpp analysis/certify/ analysis/reduction/ analysis/lft/
         analysis/damping/ analysis/control/ analysis/distributed/ analysis/shapes/)
# analysis/certify/ measures differences beside the rounding of the elimination.
internal(compiler/system/elimination_terms.hpp analysis/certify/)
internal(compiler/system/zero_pairs.hpp analysis/reduction/ analysis/distributed/)
# analysis/lft/ takes columns and rows of the transfers of opened systems.
# analysis/certify/certify_full.cpp and emit/cpp/form.cpp use transfer_if_any.
internal(compiler/system/transfer_part.hpp analysis/lft/ analysis/certify/certify_full.cpp
         emit/cpp/form.cpp)
# A System is a handle on top of the compiler: its results are functions of SystemData, which do not
# know it. In compiler/, compiler/system/system.cpp alone includes it.
set(handle compiler/system/system.hpp)

# The room of a file: that of the longest folder.
function(room_of file result)
  set(room "")
  while(file MATCHES "/" AND NOT room)
    string(REGEX REPLACE "/[^/]*$" "" file "${file}")
    if(file IN_LIST names)
      set(room ${file})
    endif()
  endwhile()
  set(${result} "${room}" PARENT_SCOPE)
endfunction()

function(is_user file header result)
  set(found FALSE)
  foreach(user ${users\ ${header}})
    string(FIND "${file}" "${user}" place)
    if(place EQUAL 0)
      set(found TRUE)
    endif()
  endforeach()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

set(files)
foreach(layer graph blocks compiler analysis emit app/generate)
  file(GLOB_RECURSE of_layer RELATIVE ${ROOT} ${ROOT}/${layer}/*.hpp ${ROOT}/${layer}/*.cpp)
  list(APPEND files ${of_layer})
endforeach()
list(REMOVE_ITEM files emit/titop.hpp)  # for users: above all rooms
foreach(file ${files})
  room_of(${file} room)
  if(NOT room)
    string(APPEND wrong "\n  ${file} is in no room")
    continue()
  endif()
  file(STRINGS ${ROOT}/${file} lines
       REGEX "include *<(lapack.*|Eigen/(LU|QR|SVD|Cholesky|Eigenvalues|Dense|SparseLU|SparseQR|SparseCholesky))>")
  if(lines AND NOT file MATCHES "^graph/linalg/")
    string(APPEND wrong "\n  ${file}: ${lines}; include titop/graph/linalg/eigen.hpp")
  endif()
  file(STRINGS ${ROOT}/${file} lines REGEX "^ *# *include *[<\"](titop|generate)/")
  foreach(line ${lines})
    string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*).*$" "\\1" header "${line}")
    string(REGEX REPLACE "^titop/" "" header "${header}")
    string(REGEX REPLACE "^generate/" "app/generate/" header "${header}")
    if(header STREQUAL handle AND file MATCHES "^compiler/"
       AND NOT file STREQUAL "compiler/system/system.cpp")
      string(APPEND wrong "\n  ${file} includes ${header}: take SystemData, or less")
    endif()
    room_of(${header} from)
    list(APPEND "used ${room}" "${from}")
    if(from STREQUAL room OR "${file} ${header}" STREQUAL "app/generate/test_source.cpp titop.hpp")
      continue()
    elseif(NOT from STREQUAL "graph" AND NOT from IN_LIST "allowed ${room}")
      string(APPEND wrong "\n  ${file} includes ${header}, ${room} may not")
    elseif(header IN_LIST headers)
      is_user(${file} ${header} listed)
      if(NOT listed)
        string(APPEND wrong "\n  ${file} includes ${header}, which is internal")
      endif()
    endif()
  endforeach()
endforeach()

# The page has a row for each room, and no other, a line for each room that is deeper than System, and
# every internal header with its users.
file(READ ${ROOT}/docs/architecture.md document)
foreach(name ${names})
  foreach(other ${allowed\ ${name}})
    if(NOT other IN_LIST "used ${name}")
      string(APPEND wrong "\n  no file of ${name} includes ${other}: take it out of the table")
    endif()
    if(name MATCHES "^(analysis|emit)/" AND other MATCHES "^compiler/"
       AND NOT other STREQUAL "compiler/system" AND NOT document MATCHES "\n- `${name}`: ")
      string(APPEND wrong "\n  docs/architecture.md has no line - `${name}`: for ${other}")
    endif()
  endforeach()
  list(TRANSFORM "allowed ${name}" REPLACE "(.+)" "`\\1`" OUTPUT_VARIABLE allowed)
  list(JOIN allowed ", " allowed)
  string(FIND "${document}" "| `${name}` | ${allowed} |" place)
  if(place EQUAL -1)
    string(APPEND wrong "\n  docs/architecture.md has no row | `${name}` | ${allowed} |")
  endif()
endforeach()
string(REGEX MATCHALL "\n\\| `(app/generate|[a-z]+)(/[a-z_]+)?` \\| [^|]*\\| " rows "${document}")
list(LENGTH rows count)
list(LENGTH names count_names)
if(NOT count EQUAL count_names)
  string(APPEND wrong "\n  docs/architecture.md has ${count} rows, there are ${count_names} rooms")
endif()
foreach(header ${headers})
  string(FIND "${document}" "- `${header}`:" start)
  if(start EQUAL -1)
    string(APPEND wrong "\n  docs/architecture.md has no line - `${header}`:")
    continue()
  endif()
  string(SUBSTRING "${document}" ${start} -1 line)
  string(REGEX REPLACE "\n(- |\n).*" "" line "${line}")  # up to the next one
  foreach(user ${header} ${users\ ${header}})
    string(FIND "${line}" "`${user}`" place)
    if(place EQUAL -1)
      string(APPEND wrong "\n  docs/architecture.md does not name ${user} at ${header}")
    endif()
  endforeach()
endforeach()
if(wrong)
  message(FATAL_ERROR "includes against the table of rooms:${wrong}")
endif()
