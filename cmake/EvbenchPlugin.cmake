# evbench_add_plugin(NAME SOURCES FILE... [LINKS LIBRARY...] [TESTS FILE...] [FOLDER DIR])
#
# Adds the target NAME: libNAME.so in the top build folder (or in DIR), built from sources that register plugins
# (<evbench/plugin.hpp>), for `evbench --plugin libNAME.so`. LINKS: libraries that the sources need in addition
# to evbench::core and evbench::events.
#
# TESTS: Catch2 sources. With the plugin's sources they form the program NAME_tests, which ctest runs; they may use the
# conformance battery (<evbench/plugin_test.hpp>). Without Catch2 the tests are left out with a message.
#
# The plugin contains its own hidden copy of the evbench code that it uses. The copy does not share state with the
# program (additional event formats, a request to end). The plugin is built with the flags that evbench was built with,
# because the layout of exchanged objects depends on them.
enable_testing()  # not in the function: its effect would end with it

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
  if(EVBENCH_PLUGIN_INCLUDE)  # outside of evbench's own build
    evbench_header_closure(headers ${EVBENCH_PLUGIN_INCLUDE} evbench/plugin.hpp)
    evbench_header_hash(hash ${EVBENCH_PLUGIN_INCLUDE} ${headers})
    list(TRANSFORM headers PREPEND ${EVBENCH_PLUGIN_INCLUDE}/)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${headers})  # another evbench may be installed later
    target_compile_definitions(${name} PRIVATE EVBENCH_PLUGIN_HEADERS="${hash}")
  endif()
  target_link_libraries(${name} PRIVATE ${name}_objects)
  evbench_plugin_flags(${name})
  target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
  if(NOT EVBENCH_SANITIZE AND NOT EVBENCH_FUZZ)
    target_link_options(${name} PRIVATE -Wl,-z,defs)  # a missing symbol is an error when linking, not when loading
  endif()
  set_target_properties(${name} PROPERTIES PREFIX lib LIBRARY_OUTPUT_DIRECTORY ${ARG_FOLDER})

  if(ARG_TESTS)
    evbench_plugin_tests(${name} ${ARG_TESTS})
  endif()
endfunction()

# Compile flags of plugins.
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
