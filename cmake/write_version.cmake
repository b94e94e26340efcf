# cmake -DSOURCE=... -DTEMPLATE=... -DOUT=... [-DNAME=VALUE...] -P write_version.cmake: fills the template with the
# checkout's commit and the given values, and writes OUT if its content changes.
execute_process(COMMAND git describe --always --dirty WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT COMMIT)
  set(COMMIT unknown)
endif()
configure_file(${TEMPLATE} ${OUT} @ONLY)
