# What all targets of evbench share: flags, include root, tests, installation.

add_library(evbench_flags INTERFACE)
target_compile_features(evbench_flags INTERFACE cxx_std_20)
target_compile_options(evbench_flags INTERFACE
  -Wall -Wextra -Wconversion -Wshadow
  # GCC 12 warns falsely about inlined Eigen code, its own AVX-512 intrinsics and std::string.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-uninitialized -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow
                           -Wno-stringop-overread>
  # GCC's -Wconversion does not include it in C++.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
  # Position-independent for plugins (and for tests, which use the same precompiled headers). The program's functions
  # are never interposed, so they may be inlined.
  -fPIC -fno-semantic-interposition
  $<$<BOOL:${EVBENCH_WERROR}>:-Werror>
  $<$<BOOL:${EVBENCH_NATIVE}>:-march=native>)
if(EVBENCH_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "EVBENCH_FUZZ needs clang++ for its libFuzzer; the compiler is ${CMAKE_CXX_COMPILER}")
  endif()
  set(fuzz_flags -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow -fno-sanitize-recover=all
                 -fno-omit-frame-pointer)
  target_compile_options(evbench_flags INTERFACE ${fuzz_flags} -D_GLIBCXX_ASSERTIONS)
  target_link_options(evbench_flags INTERFACE ${fuzz_flags})
endif()
set(EVBENCH_SANITIZE_FLAGS "")
if(EVBENCH_SANITIZE)
  set(EVBENCH_SANITIZE_FLAGS -fsanitize=${EVBENCH_SANITIZE})
  target_compile_options(evbench_flags INTERFACE ${EVBENCH_SANITIZE_FLAGS} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_definitions(evbench_flags INTERFACE EVBENCH_SANITIZED _GLIBCXX_ASSERTIONS)
  target_link_options(evbench_flags INTERFACE ${EVBENCH_SANITIZE_FLAGS})
endif()

# evbench_precompile(TARGET HEADER): with EVBENCH_PRECOMPILE, the first target precompiles HEADER and all others reuse
# it.
function(evbench_precompile target header)
  get_property(first GLOBAL PROPERTY evbench_precompiled_${header})
  if(NOT EVBENCH_PRECOMPILE)
    return()
  elseif(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    target_precompile_headers(${target} PRIVATE ${CMAKE_SOURCE_DIR}/cmake/${header}.hpp)
    set_property(GLOBAL PROPERTY evbench_precompiled_${header} ${target})
  endif()
endfunction()

# evbench_group(TARGET SIZE): with EVBENCH_GROUP, sources are compiled SIZE at a time (unity build), so that shared
# headers and templates are compiled once. Names local to one source must then be unique within the target.
function(evbench_group target size)
  if(NOT size)
    set(size 8)
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${EVBENCH_GROUP} UNITY_BUILD_BATCH_SIZE ${size})
endfunction()

# evbench_library(NAME [STATIC|OBJECT] SOURCES ... LINKS ... [PRECOMPILED HEADER] [GROUP SIZE]): the target of a folder.
# Headers are included by their path from the repository's root ("core/geometry/se3.hpp").
function(evbench_library name kind)
  cmake_parse_arguments(ARG "" "PRECOMPILED;GROUP" "SOURCES;LINKS" ${ARGN})
  add_library(${name} ${kind} ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>
                                            $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/include>
                                            $<BUILD_INTERFACE:${CMAKE_BINARY_DIR}/generated>
                                            $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_link_libraries(${name} PUBLIC ${ARG_LINKS} PRIVATE $<BUILD_INTERFACE:evbench_flags>)
  if(NOT ARG_PRECOMPILED)
    set(ARG_PRECOMPILED precompiled)
  endif()
  evbench_precompile(${name} ${ARG_PRECOMPILED})
  evbench_group(${name} "${ARG_GROUP}")
endfunction()

# evbench_tests(NAME SOURCES ... LINKS ...): the *.test.cpp of a folder as one test program. Each test case is one
# ctest, which fails when it takes longer than EVBENCH_TEST_SECONDS. Tests on real data read the environment variables
# EVBENCH_DATA and EVBENCH_PROBLEMS.
function(evbench_tests name)
  if(NOT EVBENCH_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  if(NOT TARGET evbench_test_support)
    set(testing ${CMAKE_SOURCE_DIR}/core/testing)
    set_source_files_properties(${EVBENCH_PLUGIN_TEST_MAIN} PROPERTIES SKIP_PRECOMPILE_HEADERS ON
                                                                       SKIP_UNITY_BUILD_INCLUSION ON)
    evbench_library(evbench_test_support STATIC SOURCES ${testing}/data.cpp ${EVBENCH_PLUGIN_TEST_MAIN}
                    LINKS Catch2::Catch2 evbench::core PRECOMPILED precompiled_test)
    # The same level as the tests, which use its precompiled headers.
    target_compile_options(evbench_test_support PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} evbench_test_support evbench_flags)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)  # the tested libraries are fully optimised
  evbench_precompile(${name} precompiled_test)
  evbench_group(${name} "")
  # The tests of each label, slowest label first: ctest starts tests of the highest COST first.
  set(tags "")
  foreach(source IN LISTS ARG_SOURCES)
    file(STRINGS ${source} tagged REGEX "\\[(long|random|cluster|slow)\\]")
    string(APPEND tags "${tagged}")
  endforeach()
  set(others "")
  foreach(label long random cluster slow fast)
    if(label STREQUAL "fast")
      set(spec "${others}~[.]")
      set(cost 1)
    elseif(tags MATCHES "\\[${label}\\]")
      set(spec "${others}[${label}]")
      set(cost 100)
    else()
      continue()
    endif()
    catch_discover_tests(${name} TEST_SPEC "${spec}" TEST_PREFIX "${name}: " PROPERTIES LABELS ${label} COST ${cost}
                         SKIP_REGULAR_EXPRESSION "SKIPPED:" TIMEOUT ${EVBENCH_TEST_SECONDS}
                         FAIL_REGULAR_EXPRESSION "No tests ran")  # a test name that ctest splits at a semicolon
    string(APPEND others "~[${label}]")
  endforeach()
endfunction()

# evbench_fuzz_targets(CORPUS archive LINKS ... [CORPUS_ONLY ...]): each NAME.fuzz.cpp in and below a folder becomes a
# libFuzzer program fuzz_NAME, built by the target fuzz_targets. Its test runs the inputs in NAME/ of the archive, then
# new inputs for EVBENCH_FUZZ_SECONDS in bounded memory. In the build folder, fuzz/kept/NAME is the unpacked archive,
# fuzz/corpus/NAME keeps new inputs that reach more code, and fuzz/findings/NAME-... are the inputs that fail. The
# target fuzz_corpus packs fuzz/kept into the archive again. The tests of CORPUS_ONLY try no new inputs, because
# findings there would be known bugs of a third-party library.
function(evbench_fuzz_targets)
  if(NOT EVBENCH_FUZZ)
    return()
  endif()
  cmake_parse_arguments(ARG "" "CORPUS" "LINKS;CORPUS_ONLY" ${ARGN})
  set(archive ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_CORPUS})
  set(kept ${CMAKE_BINARY_DIR}/fuzz/kept)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${archive})
  if(${archive} IS_NEWER_THAN ${kept})
    file(ARCHIVE_EXTRACT INPUT ${archive} DESTINATION ${kept})
    file(TOUCH_NOCREATE ${kept})
  endif()
  add_custom_target(fuzz_corpus COMMAND tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -czf ${archive} -C
                                            ${kept} .)
  add_custom_target(fuzz_targets)
  math(EXPR most_seconds "${EVBENCH_FUZZ_SECONDS} + 600")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.fuzz.cpp)
  foreach(source IN LISTS sources)
    get_filename_component(name ${source} NAME)
    string(REPLACE ".fuzz.cpp" "" name ${name})
    add_executable(fuzz_${name} ${source})
    target_link_libraries(fuzz_${name} PRIVATE ${ARG_LINKS} evbench_flags)
    target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
    add_dependencies(fuzz_targets fuzz_${name})
    set(found ${CMAKE_BINARY_DIR}/fuzz/corpus/${name})
    file(MAKE_DIRECTORY ${found} ${CMAKE_BINARY_DIR}/fuzz/findings)
    set(extent -max_total_time=${EVBENCH_FUZZ_SECONDS})
    if(name IN_LIST ARG_CORPUS_ONLY)
      set(extent -runs=0)
    endif()
    add_test(NAME "fuzz: ${name}"
             COMMAND fuzz_${name} ${extent} -seed=1 -timeout=60 -rss_limit_mb=1500
                     -malloc_limit_mb=700 -print_final_stats=1
                     -artifact_prefix=${CMAKE_BINARY_DIR}/fuzz/findings/${name}-
                     ${found} ${kept}/${name})
    set_tests_properties("fuzz: ${name}" PROPERTIES TIMEOUT ${most_seconds} LABELS fuzz)
  endforeach()
endfunction()

# Installs headers, libraries and the package files of find_package(evbench): everything that an external plugin may
# use. In the build folder the package files are where find_package() does not search, because they include files that
# exist only after the installation.
function(evbench_install_package)
  include(CMakePackageConfigHelpers)
  # The smoother and what it stands on, without the libraries of the rest.
  foreach(name geometry smoother)
    set_target_properties(evbench_${name} PROPERTIES EXPORT_NAME ${name})
    install(TARGETS evbench_${name} EXPORT evbench_smoother_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endforeach()
  foreach(name core eval events event_simulation pipeline battery)
    set_target_properties(evbench_${name} PROPERTIES EXPORT_NAME ${name})
    install(TARGETS evbench_${name} EXPORT evbench_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endforeach()
  install(TARGETS evbench RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(CODE "
    include(\"${CMAKE_SOURCE_DIR}/cmake/PublicHeaders.cmake\")
    evbench_header_closure(headers \"${CMAKE_SOURCE_DIR}\" include/evbench/plugin.hpp include/evbench/plugin_test.hpp
                           include/evbench/plugin_entry.hpp include/evbench/smoother.hpp)
    evbench_install_headers(\"${CMAKE_SOURCE_DIR}\"
                            \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}\" \${headers})")
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/configs DESTINATION ${CMAKE_INSTALL_DATADIR}/evbench)
  install(FILES ${CMAKE_SOURCE_DIR}/examples/python/evbench_process.py DESTINATION ${CMAKE_INSTALL_DATADIR}/evbench/python)
  evbench_install_documents()
  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/evbench)
  install(EXPORT evbench_targets NAMESPACE evbench:: DESTINATION ${package})
  install(EXPORT evbench_smoother_targets NAMESPACE evbench:: DESTINATION ${package})
  configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/evbenchConfig.cmake.in
                                ${CMAKE_BINARY_DIR}/package/evbenchConfig.cmake INSTALL_DESTINATION ${package})
  write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/evbenchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_BINARY_DIR}/package/evbenchConfig.cmake ${CMAKE_BINARY_DIR}/package/evbenchConfigVersion.cmake
                ${CMAKE_SOURCE_DIR}/cmake/EvbenchPlugin.cmake ${CMAKE_SOURCE_DIR}/cmake/PublicHeaders.cmake ${EVBENCH_PLUGIN_ENTRY} ${EVBENCH_PLUGIN_TEST_MAIN}
          DESTINATION ${package})
endfunction()

# Installs the documents under the paths that messages cite, and the shell completion and manual page, which the program
# itself writes during the installation.
function(evbench_install_documents)
  install(FILES ${CMAKE_SOURCE_DIR}/README.md ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR}
          FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png")
  if(CMAKE_CROSSCOMPILING)
    return()
  endif()
  # A folder for each installation: two of them may run at a time.
  install(CODE "
    string(MD5 id \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
    set(written \"${CMAKE_BINARY_DIR}/written/\${id}\")
    set(share \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
    set(evbench \"${CMAKE_COMMAND}\" -E env --unset=EVBENCH_PLUGINS \"$<TARGET_FILE:evbench>\")
    file(MAKE_DIRECTORY \"\${written}\")
    execute_process(COMMAND \${evbench} completion bash OUTPUT_FILE \"\${written}/evbench\" COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND \${evbench} completion zsh OUTPUT_FILE \"\${written}/_evbench\" COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND \${evbench} man OUTPUT_FILE \"\${written}/evbench.1\" COMMAND_ERROR_IS_FATAL ANY)
    file(INSTALL \"\${written}/evbench\" DESTINATION \"\${share}/bash-completion/completions\")
    file(INSTALL \"\${written}/_evbench\" DESTINATION \"\${share}/zsh/site-functions\")
    file(INSTALL \"\${written}/evbench.1\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\")")
endfunction()
