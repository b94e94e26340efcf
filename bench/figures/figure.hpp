#pragma once

#include <string>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/support/json_fwd.hpp"

namespace evbench {

/// A series: a colour and a name in the legend.
struct Series {
  std::string label;
  bool truth = false;  ///< black, thin and dashed, on top
};

/// A mark of one series in a panel.
struct Mark {
  enum class Kind {
    line,      ///< through x, y, many of them
    points,    ///< the same with a marker at each
    band,      ///< over x, from `low` to `high`
    level,     ///< across the whole panel: a line at y[0], a band from low[0] to high[0]
    steps,     ///< through x, y, level up to the next x
    failures,  ///< above the panel, at each x: `low` of `high` runs failed; without x: those of a level
    box,       ///< horizontal, at height x[0]: quartiles, median and all values y
    cells,     ///< around x, y: coloured by the ratio in `low`, white where it is 1, which is written in them
  };
  Kind kind;
  std::size_t series;
  std::vector<double> x, y = {}, low = {}, high = {};  ///< as long as x, where they are used; of a box y has any length
  /// Of points, steps and failures: the runs behind each x, of a box those behind each y, of a level one list. Empty:
  /// not known. Pictures do not need them; a report leads from a point to its runs.
  std::vector<std::vector<std::size_t>> runs = {};
};

struct PanelAxis {
  std::string label;  ///< with its unit
  bool log = false;
  bool share = false;             ///< from 0 to 1
  std::vector<double> ends = {};  ///< values that always have a tick: its first and its last one
};

/// A pair of axes with what is drawn in it.
struct Panel {
  PanelAxis x, y;
  std::vector<Mark> marks;
  std::vector<std::string> names = {};  ///< of boxes, from the top, instead of a y axis
  bool equal = false;                   ///< a metre is as long on both axes
  std::string title = {};               ///< above it
};

/// A figure for a page, made of panels in rows.
struct Figure {
  std::vector<Series> series;
  std::vector<Panel> panels;
  std::string caption;                    ///< content and protocol, in small print below
  std::vector<std::string> remarks = {};  ///< for the user: what may not be as expected
  std::size_t columns = 1;
  bool legend = true;
  bool alike = false;  ///< a metre is as long in all panels: on both axes where that is `equal`, else on the y axis
  double width_mm = 174.0, height_mm = 64.0;  ///< of the whole; of the panels alone, names being of one line each
};

/// The figure as the script has it, and with the runs of its marks. Values that are not finite are null.
Json to_json(const Figure& figure);

/// The Python script that draws a figure (bench/figures/figure.py), with all data in it. It needs matplotlib alone. Its
/// arguments are the files to write, .svg, .pdf or .png.
std::string drawing_script(const Figure& figure);

/// Throws InputError for a file name that is not .svg, .pdf or .png.
void check_figure_name(const std::string& file);

/// Draws a figure to a file. `python`: the interpreter; empty: the first of "python3" and "/usr/bin/python3" that has
/// matplotlib. Throws InputError with Python's message where there is none or drawing fails, OutputError where the file
/// can't be written. The file appears complete or not at all; the same figure gives the same bytes with the same
/// matplotlib. Returns Python's warnings, lines that each begin with a newline: the file is there, but may look wrong.
std::string draw(const Figure& figure, const std::string& file, const std::string& python);

}  // namespace evbench
