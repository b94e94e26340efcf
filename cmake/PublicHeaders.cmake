# The public headers of evbench: those that a root header includes, directly or not. In the repository they include one
# another as "core/...", where evbench is installed as "evbench/core/...".
cmake_policy(VERSION 3.22)

# evbench_header_closure(RESULT FOLDER ROOT...): headers below FOLDER, by their paths from there, roots included.
function(evbench_header_closure result folder)
  set(found ${ARGN})
  set(open ${ARGN})
  while(open)
    list(POP_FRONT open header)
    file(STRINGS ${folder}/${header} includes REGEX "^#include \"(evbench/)?(core|eval|bench)/")
    foreach(include IN LISTS includes)
      string(REGEX REPLACE "^#include \"([^\"]*)\".*" "\\1" include "${include}")
      if(NOT EXISTS ${folder}/${include} OR include IN_LIST found)
        continue()  # what does not exist is the compiler's to report
      endif()
      list(APPEND found ${include})
      list(APPEND open ${include})
    endforeach()
  endwhile()
  list(SORT found)
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# evbench_header_hash(RESULT FOLDER HEADER...): of what the compiler sees: without comments, spaces and prefixes.
function(evbench_header_hash result folder)
  set(text "")
  foreach(header IN LISTS ARGN)
    file(READ ${folder}/${header} content)
    string(REGEX REPLACE "//[^\n]*" "" content "${content}")
    string(REPLACE "\"evbench/" "\"" content "${content}")
    string(REGEX REPLACE "[ \n]+" "" content "${content}")
    string(SHA256 hash "${content}")
    string(APPEND text ${hash})
  endforeach()
  string(SHA256 hash "${text}")
  string(SUBSTRING ${hash} 0 12 hash)
  set(${result} ${hash} PARENT_SCOPE)
endfunction()

# evbench_install_headers(FOLDER DESTINATION HEADER...): copies them, with their includes as they are found there.
function(evbench_install_headers folder destination)
  foreach(header IN LISTS ARGN)
    file(READ ${folder}/${header} content)
    string(REGEX REPLACE "#include \"(core|eval|bench)/" "#include \"evbench/\\1/" content "${content}")
    string(REGEX REPLACE "^include/evbench/" "" place ${header})
    file(WRITE ${destination}/evbench/${place} "${content}")
  endforeach()
endfunction()
