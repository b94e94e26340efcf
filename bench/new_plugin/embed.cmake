# evbench_embed_templates(OUTPUT): writes a source with template_files() (bench/new_plugin/templates.hpp), so that the
# program has the templates wherever it is. Configuring again follows a change of theirs.
function(evbench_embed_templates output)
  set(root ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/templates)
  file(GLOB files CONFIGURE_DEPENDS RELATIVE ${root} ${root}/*/*)
  set(entries "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${root}/${file})
    get_filename_component(kind ${file} DIRECTORY)
    get_filename_component(name ${file} NAME)
    file(READ ${root}/${file} text)
    string(APPEND entries "    {\"${kind}\", \"${name}\", R\"TEMPLATE(${text})TEMPLATE\"},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT "// Made by bench/new_plugin/embed.cmake.
#include \"bench/new_plugin/templates.hpp\"

namespace evbench {
namespace {

constexpr TemplateFile kFiles[] = {
@entries@};

}  // namespace

std::span<const TemplateFile> template_files() { return kFiles; }

}  // namespace evbench
")
endfunction()
