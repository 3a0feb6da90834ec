# titop_generate_model by itself: what it makes depends on the data that it is given, and what would
# be no number in C++ is refused. The commands that make targets are stood in for.
function(add_custom_command)
  cmake_parse_arguments(PARSE_ARGV 0 arg "VERBATIM" "OUTPUT;COMMENT" "BYPRODUCTS;COMMAND;DEPENDS")
  message("depends on ${arg_DEPENDS}")
endfunction()
foreach(command add_executable target_link_libraries add_custom_target add_library
                target_include_directories add_dependencies)
  cmake_language(EVAL CODE "function(${command})\nendfunction()")
endforeach()

include(${ROOT}/emit/cpp/titop-generate-model.cmake)
set(CMAKE_CURRENT_BINARY_DIR ${FOLDER})
titop_generate_model(lag ${KEYWORD} lag.cpp DATA ${DATA} SAMPLE_TIME ${SAMPLE_TIME})
