# Faster builds with an unchanged result: ccache and a fast linker where they are installed.

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(--param=ggc-min-heapsize=524288)  # [kB] later garbage collection saves a tenth of the time
endif()

if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(EVBENCH_CCACHE ccache)
  if(EVBENCH_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
        CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${EVBENCH_CCACHE})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      add_compile_options(-fpch-preprocess)  # ccache needs it with precompiled headers
    endif()
  endif()
endif()

include(CheckLinkerFlag)
foreach(linker mold lld)
  check_linker_flag(CXX -fuse-ld=${linker} EVBENCH_HAS_${linker})
  if(EVBENCH_HAS_${linker})
    add_link_options(-fuse-ld=${linker})
    break()
  endif()
endforeach()
