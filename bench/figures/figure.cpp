#include "bench/figures/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "bench/figures/figure_script.hpp"
#include "core/io/atomic_file.hpp"
#include "core/io/part_file.hpp"
#include "core/process/child_process.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::array kKindNames = {"line", "points", "band", "level", "steps", "failures", "box", "cells"};

/// Python's JSON has no infinity; values that are not finite are not drawn.
Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(std::isfinite(value) ? Json(value) : Json());
  return list;
}

Json to_json(const Mark& mark) {
  Json json = {{"kind", kKindNames[static_cast<std::size_t>(mark.kind)]}, {"series", mark.series}};
  json["x"] = numbers(mark.x);
  json["y"] = numbers(mark.y);
  json["low"] = numbers(mark.low);
  json["high"] = numbers(mark.high);
  if (!mark.runs.empty()) json["runs"] = mark.runs;
  return json;
}

Json to_json(const PanelAxis& axis) {
  return {{"label", axis.label},
          {"scale", axis.log ? "log" : "linear"},
          {"share", axis.share},
          {"ends", numbers(axis.ends)}};
}

Json to_json(const Panel& panel) {
  Json json = {{"x", to_json(panel.x)},
               {"y", to_json(panel.y)},
               {"names", panel.names},
               {"equal", panel.equal},
               {"title", panel.title}};
  json["marks"] = Json::array();
  for (const Mark& mark : panel.marks) json["marks"].push_back(to_json(mark));
  return json;
}

/// As many as fit side by side.
std::size_t legend_columns(const Figure& figure) {
  constexpr double kLetter = 1.35, kLine = 11.0;  // [mm] of a letter; of the line before a name
  std::size_t longest = 1;
  for (const Series& series : figure.series) longest = std::max(longest, series.label.size());
  const double width = kLine + kLetter * static_cast<double>(longest);
  return std::max(std::size_t{1}, static_cast<std::size_t>(figure.width_mm / width));
}

constexpr double kPatience = 120.0;  ///< [s] for drawing

bool has_matplotlib(const std::string& python) {
  try {
    ChildProcess({python, "-c", "import matplotlib; print()"}, "").exchange("\n", kPatience);
    return true;
  } catch (const ProcessError&) {
    return false;
  }
}

std::string find_python() {
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    if (has_matplotlib(python)) return python;
  }
  throw InputError(
      "figures are drawn by Python's matplotlib, which python3 does not have; expected Debian's package "
      "python3-matplotlib, or --python with one that has it");
}

}  // namespace

Json to_json(const Figure& figure) {
  Json json = {{"width_mm", figure.width_mm},
               {"height_mm", figure.height_mm},
               {"columns", figure.columns},
               {"legend", figure.legend},
               {"alike", figure.alike},
               {"caption", figure.caption},
               {"legend_columns", legend_columns(figure)}};
  json["series"] = Json::array();
  std::size_t number = 0;  // of the colour: the truth has none
  for (const Series& series : figure.series) {
    json["series"].push_back({{"label", series.label}, {"truth", series.truth}, {"number", number}});
    number += series.truth ? 0 : 1;
  }
  json["panels"] = Json::array();
  for (const Panel& panel : figure.panels) json["panels"].push_back(to_json(panel));
  return json;
}

std::string drawing_script(const Figure& figure) {
  std::string script(figure_script());
  const std::string place = "@DATA@";
  std::string data = to_json(figure).dump(-1, ' ', true);  // ASCII, whatever the file's encoding
  return script.replace(script.find(place), place.size(), data);
}

void check_figure_name(const std::string& file) {
  const std::filesystem::path extension = std::filesystem::path(file).extension();
  if (extension == ".svg" || extension == ".pdf" || extension == ".png") return;
  throw InputError(fmt::format("{}: is no .svg, .pdf or .png; expected one of these", file));
}

std::string draw(const Figure& figure, const std::string& file, const std::string& python) {
  PartFile{file};  // errors name the requested file, not the temporary ones below
  const std::string interpreter = python.empty() ? find_python() : python;
  const std::filesystem::path target(file);
  // In the target's folder, so that it can be renamed; with its extension, which gives matplotlib the format.
  const std::string part = file + ".part" + target.extension().string(), script = file + ".part.py";
  write_file(script, drawing_script(figure));
  std::string failure, warnings;
  try {
    ChildProcess process({interpreter, script, part}, "");
    try {
      process.exchange("\n", kPatience);  // it prints a line when it is done
      process.close(kPatience);
      warnings = process.errors().text("  ");
    } catch (const ProcessError& error) {
      failure = error.what() + process.errors().text("  ");
    }
  } catch (const ProcessError& error) {
    failure = error.what();
  }
  std::error_code error;
  std::filesystem::remove(script, error);
  if (!failure.empty()) {
    std::filesystem::remove(part, error);
    throw InputError(fmt::format("{}: could not be drawn: \"{}\" {}", file, interpreter, failure));
  }
  std::filesystem::rename(part, target, error);
  if (error) throw OutputError(fmt::format("{}: can't be written: {}", file, error.message()));
  return warnings;
}

}  // namespace evbench
