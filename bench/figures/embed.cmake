# evbench_embed_figure_script(OUTPUT): writes a source with figure_script() (bench/figures/figure_script.hpp), so that the
# program has figure.py wherever it is. Configuring again follows a change of it.
function(evbench_embed_figure_script output)
  set(script ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/figure.py)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${script})
  file(READ ${script} text)
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT "// Made by bench/figures/embed.cmake.
#include \"bench/figures/figure_script.hpp\"

namespace evbench {

std::string_view figure_script() { return R\"SCRIPT(@text@)SCRIPT\"; }

}  // namespace evbench
")
endfunction()
