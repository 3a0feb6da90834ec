# SOURCE must compile as it stands (else the test proves nothing) and fail with -DMUST_NOT_COMPILE.
# If it has a line "// expect: text", the compiler's message must contain that text: then it fails
# for the right reason.
set(compile ${COMPILER} -std=c++20 -fsyntax-only -I${INCLUDE} -isystem ${EIGEN} ${SOURCE})
execute_process(COMMAND ${compile} RESULT_VARIABLE code ERROR_VARIABLE text)
if(NOT code EQUAL 0)
  message("${text}")
  message(FATAL_ERROR "the positive control does not compile")
endif()

execute_process(COMMAND ${compile} -DMUST_NOT_COMPILE RESULT_VARIABLE code ERROR_VARIABLE text)
if(code EQUAL 0)
  message(FATAL_ERROR "${SOURCE} compiles with MUST_NOT_COMPILE")
endif()
file(STRINGS ${SOURCE} expected REGEX "^// expect: ")
foreach(line ${expected})
  string(REGEX REPLACE "^// expect: " "" line "${line}")
  string(FIND "${text}" "${line}" found)
  if(found EQUAL -1)
    message("${text}")
    message(FATAL_ERROR "it fails, but not with \"${line}\"")
  endif()
endforeach()
