#pragma once

#include <span>
#include <string_view>

namespace evbench {

/// A file of bench/new_plugin/templates, as it was when the program was built.
struct TemplateFile {
  std::string_view kind;  ///< backend, frontend or source: its folder there
  std::string_view name;  ///< in that folder
  std::string_view text;
};

/// All of them; bench/new_plugin/embed.cmake makes them part of the program.
std::span<const TemplateFile> template_files();

}  // namespace evbench
