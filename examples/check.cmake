# Runs PROGRAM in the empty FOLDER and compares its output with the file EXPECTED byte by byte, if
# that file exists. With TITOP_ACCEPT in the environment the output becomes the expected one.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
set(output ${FOLDER}/output.txt)
execute_process(COMMAND ${PROGRAM} WORKING_DIRECTORY ${FOLDER} OUTPUT_FILE ${output}
                ERROR_VARIABLE errors RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  file(READ ${output} text)
  message("${text}\n${errors}")
  message(FATAL_ERROR "${PROGRAM} ends with ${code}")
endif()
if(DEFINED ENV{TITOP_ACCEPT})
  file(COPY_FILE ${output} ${EXPECTED})
endif()
if(EXISTS ${EXPECTED})
  execute_process(COMMAND diff -u ${EXPECTED} ${output} OUTPUT_VARIABLE difference
                  RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message("${difference}")
    message(FATAL_ERROR "the output has changed; if rightly so: TITOP_ACCEPT=1 ctest -R example")
  endif()
endif()
