# Builds the site (mkdocs) and the reference of the public headers (Doxygen): a warning is an error.
find_program(mkdocs mkdocs)
find_program(doxygen doxygen)
if(NOT mkdocs OR NOT doxygen)
  message("SKIPPED: mkdocs or doxygen is not installed")
  return()
endif()
file(MAKE_DIRECTORY ${ROOT}/build/docs)
execute_process(COMMAND ${mkdocs} build --strict --quiet WORKING_DIRECTORY ${ROOT} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${doxygen} docs/doxygen/Doxyfile WORKING_DIRECTORY ${ROOT} OUTPUT_QUIET ERROR_VARIABLE warnings
                COMMAND_ERROR_IS_FATAL ANY)
if(NOT warnings STREQUAL "")
  message(FATAL_ERROR "${warnings}")
endif()
