# Set-up of the installation checks: installs BUILD into WORK/prefix and sets `evbench` to the installed program.

# run(COMMAND ... [OUTPUT REGEX] [REFUSED REGEX]): runs a command in WORK. Fails unless the command succeeds and prints
# OUTPUT or, with REFUSED, ends with exit code 2 and a message that matches REFUSED.
function(run)
  cmake_parse_arguments(ARG "" "OUTPUT;REFUSED" "COMMAND" ${ARGN})
  execute_process(COMMAND ${ARG_COMMAND} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result
                  OUTPUT_VARIABLE output ERROR_VARIABLE error)
  list(JOIN ARG_COMMAND " " command)
  if(ARG_REFUSED)
    if(NOT result EQUAL 2 OR NOT error MATCHES "${ARG_REFUSED}")
      message(FATAL_ERROR "${command}\n${output}${error}\nexpected exit code 2 (it is ${result}) and ${ARG_REFUSED}")
    endif()
  elseif(NOT result EQUAL 0)
    message(FATAL_ERROR "${command}\n${output}${error}\nexit code ${result}")
  elseif(ARG_OUTPUT AND NOT output MATCHES "${ARG_OUTPUT}")
    message(FATAL_ERROR "${command}\n${output}${error}\nexpected to see ${ARG_OUTPUT}")
  endif()
endfunction()

set(ENV{CXX} ${CXX})  # plugins need the program's compiler
set(evbench ${WORK}/prefix/bin/evbench)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
run(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
