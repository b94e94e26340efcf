#pragma once

#include <span>
#include <string_view>

namespace evbench {

/// A file of bench/new_plugin/templates, embedded into the program.
struct TemplateFile {
  std::string_view kind;  ///< backend, backend_minimal, frontend or source: its folder there
  std::string_view name;  ///< in that folder
  std::string_view text;
};

/// All template files. bench/new_plugin/embed.cmake embeds them.
std::span<const TemplateFile> template_files();

}  // namespace evbench
