# cmake -DBUILD=... -DWORK=... -DGENERATOR=... -DCXX=... [-DFLAGS=...] -P check_install.cmake: installs evbench to a
# temporary prefix. Outside the build tree it builds and runs the programs that use the installed smoother, and takes a
# new plugin of each kind from `evbench new-plugin` to a table. It checks that the documents that messages cite are
# installed, and that the program refuses libraries that are not plugins of this evbench.
cmake_minimum_required(VERSION 3.22)

include(${CMAKE_CURRENT_LIST_DIR}/installed_evbench.cmake)
set(kinds backend frontend source)

run(COMMAND ${evbench} list)
foreach(kind IN LISTS kinds)
  run(COMMAND ${evbench} new-plugin ${kind} my_${kind} --out ${WORK}/project/my_${kind} OUTPUT "build/libmy_${kind}.so")
endforeach()
run(COMMAND ${evbench} new-plugin backend my_minimal --minimal --out ${WORK}/project/my_minimal
    OUTPUT "build/libmy_minimal.so")

# One project for all, configured once.
file(WRITE ${WORK}/project/CMakeLists.txt [[
cmake_minimum_required(VERSION 3.22)
project(installed_plugins LANGUAGES CXX)
enable_testing()
foreach(kind backend frontend source minimal)
  add_subdirectory(my_${kind})
endforeach()
find_package(evbench 1.0 REQUIRED)
evbench_add_plugin(ten_lines SOURCES ten_lines.cpp)
foreach(name no_plugin other_abi missing_symbol)
  add_library(${name} MODULE ${name}.cpp)
  set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/odd)
endforeach()
]])
# The example at the beginning of plugin.hpp.
file(READ ${WORK}/prefix/include/evbench/plugin.hpp ten_lines)
string(REGEX REPLACE "^.*\n///     (#include .*)\n///\n/// Front-ends.*$" "\\1\n" ten_lines "${ten_lines}")
string(REGEX REPLACE "\n///    ?" "\n" ten_lines "${ten_lines}")
file(WRITE ${WORK}/project/ten_lines.cpp "${ten_lines}")
file(WRITE ${WORK}/project/no_plugin.cpp "extern \"C\" int something() { return 1; }\n")
file(WRITE ${WORK}/project/other_abi.cpp [[
extern "C" const char* evbench_plugin_abi() { return "evbench plugin ABI: api 99; gcc 3"; }
]])
file(WRITE ${WORK}/project/missing_symbol.cpp "int nobody_has_this();\nextern \"C\" int something() { return nobody_has_this(); }\n")

run(COMMAND ${CMAKE_COMMAND} -S ${WORK}/project -B ${WORK}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix
            -DCMAKE_CXX_FLAGS_RELEASE=-O1 "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build)
run(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${WORK}/build --output-on-failure OUTPUT "100% tests passed")

# The smoother's examples need no library of the rest.
get_filename_component(root ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
run(COMMAND ${CMAKE_COMMAND} -S ${root}/examples/smoother -B ${WORK}/smoother -G ${GENERATOR}
            -DCMAKE_PREFIX_PATH=${WORK}/prefix "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(COMMAND ${CMAKE_COMMAND} --build ${WORK}/smoother)
run(COMMAND ${WORK}/smoother/circle OUTPUT "error 0[.]0[0-9]+ m, sigma 0[.]0[0-9]+ m")
run(COMMAND ${WORK}/smoother/solve_file ${WORK}/none.txt REFUSED "none.txt")
if(DEFINED ENV{EVBENCH_PROBLEMS})
  run(COMMAND ${WORK}/smoother/solve_file $ENV{EVBENCH_PROBLEMS}/small.txt.gz OUTPUT "cost [0-9]")
endif()
find_program(READELF readelf REQUIRED)
execute_process(COMMAND ${READELF} -d ${WORK}/smoother/circle OUTPUT_VARIABLE needed COMMAND_ERROR_IS_FATAL ANY)
if(needed MATCHES "opencv|tbb|yaml|archive|hdf5|ssl|crypto")
  message(SEND_ERROR "a program that uses the smoother alone needs ${needed}; expected cholmod and what it stands on")
endif()

# Strangers include <evbench/...> and find nothing else.
file(GLOB folders RELATIVE ${WORK}/prefix/include ${WORK}/prefix/include/*)
if(NOT folders STREQUAL "evbench" OR EXISTS ${WORK}/prefix/include/evbench/eval)
  message(SEND_ERROR "headers are installed in ${folders}; expected evbench alone, without evbench/eval")
endif()

foreach(kind IN LISTS kinds)
  set(library ${WORK}/build/libmy_${kind}.so)
  run(COMMAND ${evbench} --plugin ${library} list OUTPUT "my_${kind} [^\n]*libmy_${kind}.so")
  run(COMMAND ${evbench} run ${WORK}/project/my_${kind}/config.json --out ${WORK}/results --plugin ${library}
      OUTPUT "my_backend +[0-9]|gp_map +[0-9]")
endforeach()
run(COMMAND ${evbench} run ${WORK}/project/my_minimal/config.json --out ${WORK}/results --plugin
            ${WORK}/build/libmy_minimal.so OUTPUT "my_minimal +[0-9]")
run(COMMAND ${evbench} --plugin ${WORK}/build/libten_lines.so list OUTPUT "at_rest [^\n]*libten_lines.so")
run(COMMAND ${evbench} table ${WORK}/results/my_backend OUTPUT "my_backend +[0-9]")
run(COMMAND ${CMAKE_COMMAND} -E env EVBENCH_PLUGINS=${WORK}/build ${evbench} check-plugin my_source OUTPUT "ok")

# Documents that help texts and descriptions cite; shell completion and manual page.
set(share ${WORK}/prefix/share)
execute_process(COMMAND ${evbench} --help-all OUTPUT_VARIABLE texts COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${evbench} list OUTPUT_VARIABLE list COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[a-z_]+/[a-z_/]+\\.md" cited "${texts}${list}")
foreach(document IN LISTS cited ITEMS docs/reference/process_protocol.md docs/guides/sweep.md docs/reference/metrics.md README.md)
  if(NOT EXISTS ${share}/doc/evbench/${document})
    message(SEND_ERROR "${document} is cited, and is not installed in ${share}/doc/evbench; expected it there")
  endif()
endforeach()
run(COMMAND bash -n ${share}/bash-completion/completions/evbench)
foreach(file zsh/site-functions/_evbench man/man1/evbench.1 evbench/python/evbench_process.py)
  file(SIZE ${share}/${file} size)
  if(size LESS 500)
    message(SEND_ERROR "${share}/${file} has ${size} bytes; expected all of it")
  endif()
endforeach()

file(WRITE ${WORK}/text.so "no library")
file(COPY_FILE ${WORK}/build/libmy_source.so ${WORK}/twin.so)
run(COMMAND ${evbench} --plugin ${WORK}/none.so list REFUSED "none.so: no such file")
run(COMMAND ${evbench} --plugin ${WORK}/text.so list REFUSED "text.so: can't be loaded as a shared library")
run(COMMAND ${evbench} --plugin ${WORK}/build/odd/libno_plugin.so list REFUSED "is no plugin of evbench")
run(COMMAND ${evbench} --plugin ${WORK}/build/odd/libother_abi.so list REFUSED "it has api 99 instead of api ")
run(COMMAND ${evbench} --plugin ${WORK}/build/odd/libmissing_symbol.so list REFUSED "undefined symbol: .*nobody_has_this")
run(COMMAND ${evbench} --plugin ${WORK}/build --plugin ${WORK}/twin.so list
    REFUSED "two sources are called \"my_source\".*libmy_source.so.*twin.so")

# A plugin that was built with other headers is refused, though nobody raised the version.
set(header ${WORK}/prefix/include/evbench/core/plugin/backend.hpp)
file(READ ${header} content)
string(REPLACE "virtual void finish() = 0;" "virtual void finish() = 0; virtual void changed() {}" content "${content}")
file(WRITE ${header} "${content}")
run(COMMAND ${CMAKE_COMMAND} -S ${WORK}/project/my_minimal -B ${WORK}/changed -G ${GENERATOR}
            -DCMAKE_PREFIX_PATH=${WORK}/prefix "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(COMMAND ${CMAKE_COMMAND} --build ${WORK}/changed)
run(COMMAND ${evbench} --plugin ${WORK}/changed/libmy_minimal.so list REFUSED "it has api [0-9]+ with headers ")
file(REMOVE_RECURSE ${WORK})
