# evbench_add_plugin(NAME SOURCES FILE... [LINKS LIBRARY...] [TESTS FILE...] [FOLDER DIR])
#
# Makes the target NAME, libNAME.so in the top build folder (or in DIR), from sources that register plugins
# (core/plugin/registration.hpp), for `evbench --plugin libNAME.so`. LINKS: what the sources need besides evbench::core
# and evbench::events.
#
# TESTS: sources for Catch2, built with the plugin's into the program NAME_tests, a test of ctest's; they may use the
# conformance battery (bench/battery/). Left out, with a line that says so, where Catch2 is not there.
#
# The plugin has a copy of its own of all of evbench that it uses, and shows nothing of it, so that it and the program
# don't mix: state that the program keeps (further formats of events, a request to end) is not the copy's. It is built
# with the flags on which the layout of exchanged objects depends: those that evbench was built with.
enable_testing()  # here and not in a function, whose end would take it back

function(evbench_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "FOLDER" "SOURCES;LINKS;TESTS")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "evbench_add_plugin(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}; expected SOURCES, "
                        "LINKS, TESTS and FOLDER")
  endif()
  if(NOT ARG_SOURCES)
    message(FATAL_ERROR "evbench_add_plugin(${name}): has no SOURCES; expected the files that register the plugin")
  endif()
  if(NOT ARG_FOLDER)
    set(ARG_FOLDER ${CMAKE_BINARY_DIR})
  endif()
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()

  # Compiled once, for the library and its tests.
  add_library(${name}_objects OBJECT ${ARG_SOURCES})
  target_link_libraries(${name}_objects PUBLIC ${EVBENCH_PLUGIN_LIBRARIES} ${ARG_LINKS})
  evbench_plugin_flags(${name}_objects)

  add_library(${name} MODULE ${EVBENCH_PLUGIN_ENTRY})
  target_link_libraries(${name} PRIVATE ${name}_objects)
  evbench_plugin_flags(${name})
  target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
  if(NOT EVBENCH_SANITIZE AND NOT EVBENCH_FUZZ)
    target_link_options(${name} PRIVATE -Wl,-z,defs)  # told when it is built, not when it is loaded
  endif()
  set_target_properties(${name} PROPERTIES PREFIX lib LIBRARY_OUTPUT_DIRECTORY ${ARG_FOLDER})

  if(ARG_TESTS)
    evbench_plugin_tests(${name} ${ARG_TESTS})
  endif()
endfunction()

# The flags of everything that goes into a plugin.
function(evbench_plugin_flags target)
  target_compile_features(${target} PRIVATE cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON
                                             CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(TARGET evbench_flags)  # in evbench's own build
    target_link_libraries(${target} PRIVATE evbench_flags)
    return()
  endif()
  if(EVBENCH_NATIVE)
    target_compile_options(${target} PRIVATE -march=native)
  endif()
  if(EVBENCH_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${EVBENCH_SANITIZE})
    target_link_options(${target} PRIVATE -fsanitize=${EVBENCH_SANITIZE})
  endif()
endfunction()

function(evbench_plugin_tests name)
  find_package(Catch2 QUIET)
  if(NOT TARGET Catch2::Catch2)
    message(STATUS "${name}: built without its tests, which need Catch2")
    return()
  endif()
  add_executable(${name}_tests ${ARGN} ${EVBENCH_PLUGIN_TEST_MAIN})
  target_link_libraries(${name}_tests PRIVATE ${name}_objects evbench::battery Catch2::Catch2)
  evbench_plugin_flags(${name}_tests)
  add_test(NAME ${name} COMMAND ${name}_tests)
endfunction()
