# cmake -DBUILD=... -DWORK=... -DGENERATOR=... [-DFLAGS=...] -P check_install.cmake: installs to a temporary prefix and
# builds and runs a project that finds evbench there.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
file(WRITE ${WORK}/project/CMakeLists.txt [[
cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES CXX)
find_package(evbench 0.1 REQUIRED)
add_executable(user user.cpp)
target_link_libraries(user PRIVATE evbench::core evbench::eval)
]])
file(WRITE ${WORK}/project/user.cpp [[
#include "core/geometry/se3.hpp"
#include "eval/scores.hpp"

int main() {
  std::vector<evbench::StampedPose> poses;
  for (int i = 0; i < 50; ++i) {
    const double t = 0.1 * i;
    const evbench::Vector6 xi = (evbench::Vector6() << 0.1 * t, 0.0, 0.0, t, t * t, 0.0).finished();
    poses.push_back({t, evbench::se3::exp(xi)});
  }
  const evbench::PoseTrajectory trajectory(std::move(poses));
  return evbench::score(trajectory, trajectory, {}).pairs == 50 ? 0 : 1;
}
]])
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${WORK}/project -B ${WORK}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O1 "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/user)
run(${WORK}/prefix/bin/evbench list)
file(REMOVE_RECURSE ${WORK})
