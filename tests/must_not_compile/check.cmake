# FILE must compile as it stands (else the test proves nothing) and fail with -DMUST_NOT_COMPILE.
set(flags -std=c++20 -fsyntax-only -I${INCLUDE} -isystem ${EIGEN})
execute_process(COMMAND ${COMPILER} ${flags} ${FILE} RESULT_VARIABLE good ERROR_VARIABLE text)
if(NOT good EQUAL 0)
  message(FATAL_ERROR "the positive control does not compile:\n${text}")
endif()
execute_process(COMMAND ${COMPILER} ${flags} -DMUST_NOT_COMPILE ${FILE}
                RESULT_VARIABLE bad ERROR_VARIABLE text)
if(bad EQUAL 0)
  message(FATAL_ERROR "${FILE} compiles with MUST_NOT_COMPILE")
endif()
