# titop_generate_model(NAME
#   DIAGRAM file.cpp ...        # sources that define: titop::Diagram FUNCTION(); SCENE in titop 0.1
#   [FUNCTION function]         # its name, in the global namespace; NAME if left out
#   [SAMPLE_TIME seconds]       # also `step`, exact for inputs held that long
#   [STATES automatic|model|modes]
#   [DATA file ...]             # files that the sources read while they run: made again when one changes
#   [LIBRARIES target ...])     # libraries of the sources besides titop
#
# Compiles the diagram while your project is built and writes its model as C++17 (see
# <titop/emit/cpp/cpp.hpp>). The target NAME is an interface library: link it and include
# "NAME.hpp". Where doctest is found (find_package(doctest) before) and tests are enabled, NAME_test
# proves the header in ctest.
function(titop_generate_model name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "FUNCTION;SAMPLE_TIME;STATES" "DIAGRAM;SCENE;DATA;LIBRARIES")
  list(APPEND arg_DIAGRAM ${arg_SCENE})
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_DIAGRAM)
    message(FATAL_ERROR "titop_generate_model(${name}): give DIAGRAM file.cpp ...; "
                        "not understood: '${arg_UNPARSED_ARGUMENTS}'")
  endif()
  if(NOT arg_FUNCTION)
    set(arg_FUNCTION ${name})
  endif()
  if(NOT arg_SAMPLE_TIME)
    set(arg_SAMPLE_TIME 0)
  endif()
  # It becomes C++, where 1/100 would be 0 and 010 eight.
  if(NOT arg_SAMPLE_TIME MATCHES "^((0|[1-9][0-9]*)(\\.[0-9]*)?|\\.[0-9]+)([eE][-+]?[0-9]+)?$")
    message(FATAL_ERROR "titop_generate_model(${name}): SAMPLE_TIME ${arg_SAMPLE_TIME} is no "
                        "number: give seconds, such as 0.01")
  endif()
  if(NOT arg_STATES)
    set(arg_STATES automatic)
  endif()
  if(NOT arg_STATES MATCHES "^(automatic|model|modes)$")
    message(FATAL_ERROR "titop_generate_model(${name}): STATES ${arg_STATES} is none of "
                        "automatic, model, modes")
  endif()

  set(data)
  foreach(file ${arg_DATA})
    get_filename_component(file ${file} ABSOLUTE)
    if(NOT EXISTS ${file})
      message(FATAL_ERROR "titop_generate_model(${name}): DATA ${file} does not exist")
    endif()
    list(APPEND data ${file})
  endforeach()

  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${name}_model)
  file(MAKE_DIRECTORY ${folder})
  file(CONFIGURE OUTPUT ${folder}/generate.cpp @ONLY CONTENT [[
// Writes @name@.hpp and @name@_test.cpp into the folder that it is given.
#include <cstdio>
#include <exception>
#include <titop/titop.hpp>

titop::Diagram @arg_FUNCTION@();

int main(int, char** arguments) try {
  const titop::CppOptions options{
      .name = "@name@", .sample_time = @arg_SAMPLE_TIME@, .states = titop::CppStates::@arg_STATES@};
  titop::write(titop::generate_cpp(titop::compile(@arg_FUNCTION@()), options), arguments[1]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
]])
  add_executable(${name}_generate ${folder}/generate.cpp ${arg_DIAGRAM})
  target_link_libraries(${name}_generate PRIVATE titop::titop ${arg_LIBRARIES})
  # The files are left alone where they do not change; the stamp says when that was looked at.
  add_custom_command(OUTPUT ${folder}/written
                     BYPRODUCTS ${folder}/${name}.hpp ${folder}/${name}_test.cpp
                     COMMAND ${name}_generate ${folder}
                     COMMAND ${CMAKE_COMMAND} -E touch ${folder}/written
                     DEPENDS ${name}_generate ${data} VERBATIM
                     COMMENT "Generating ${name}.hpp")
  add_custom_target(${name}_written DEPENDS ${folder}/written)
  add_library(${name} INTERFACE)
  target_include_directories(${name} INTERFACE ${folder})
  add_dependencies(${name} ${name}_written)

  if(TARGET doctest::doctest)
    set_source_files_properties(${folder}/${name}_test.cpp PROPERTIES GENERATED TRUE)
    add_executable(${name}_test ${folder}/${name}_test.cpp)
    target_compile_features(${name}_test PRIVATE cxx_std_17)
    target_link_libraries(${name}_test PRIVATE ${name} doctest::doctest)
    add_dependencies(${name}_test ${name}_written)
    add_test(NAME ${name}.generated COMMAND ${name}_test)
  endif()
endfunction()
