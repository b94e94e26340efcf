# cmake -DROOT=... -DBUILD=... -DWORK=... -DGENERATOR=... -DCXX=... [-DFLAGS=...] -P check_example.cmake: installs
# evbench to a temporary prefix and follows the README of examples/spline_map with a copy outside the source and build
# trees. It builds the copy, runs its tests (with the conformance battery), and compares it with the built-in back-ends
# in one thread and in two.
cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/installed_evbench.cmake)

file(COPY ${ROOT}/examples/spline_map DESTINATION ${WORK} PATTERN build EXCLUDE)
set(example ${WORK}/spline_map)
run(COMMAND ${CMAKE_COMMAND} -S ${example} -B ${example}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix
            -DCMAKE_CXX_FLAGS_RELEASE=-O1 "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(COMMAND ${CMAKE_COMMAND} --build ${example}/build)
run(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${example}/build --output-on-failure OUTPUT "100% tests passed")
foreach(mode sequential concurrent)
  run(COMMAND ${evbench} run ${example}/table1_simulated.json --set source.duration=8 --set pipeline.mode=${mode}
              --out ${WORK}/${mode} OUTPUT "B-spline +0\\.0")
  file(GLOB trajectory ${WORK}/${mode}/*/spline_map-*/final.tum)
  file(SHA256 ${trajectory} ${mode})
endforeach()
if(NOT sequential STREQUAL concurrent)
  message(FATAL_ERROR "spline_map's trajectory with one thread differs from that with two")
endif()
file(REMOVE_RECURSE ${WORK})
