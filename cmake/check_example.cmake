# cmake -DROOT=... -DBUILD=... -DWORK=... -DGENERATOR=... -DCXX=... [-DFLAGS=...] -P check_example.cmake: installs to a temporary
# prefix and does with a copy of examples/spline_map what its README says, outside the source and the build tree: builds
# it, passes its tests (the conformance battery among them), and compares it with the built-in back-ends, in one thread
# and in two.
cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/as_stranger.cmake)

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
  message(FATAL_ERROR "spline_map's trajectory in one thread differs from that in two")
endif()
file(REMOVE_RECURSE ${WORK})
