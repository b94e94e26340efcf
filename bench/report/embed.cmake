# evbench_embed_report_page(OUTPUT): writes a source with page_template() (bench/report/report.hpp), so that the program
# has the page wherever it is. Configuring again follows a change of it.
function(evbench_embed_report_page output)
  set(page ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/page/report.html)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${page})
  file(READ ${page} text)
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT "// Made by bench/report/embed.cmake.
#include \"bench/report/report.hpp\"

namespace evbench::report {

std::string_view page_template() { return R\"EVBENCHPAGE(@text@)EVBENCHPAGE\"; }

}  // namespace evbench::report
")
endfunction()
