#pragma once

#include <string>
#include <vector>

#include "core/plugin/options.hpp"

namespace evbench {

/// What a colour and a name in the legend stand for.
struct Series {
  std::string label;
  bool truth = false;  ///< black, thin and dashed, on top
};

/// Something drawn in a panel, of one series.
struct Mark {
  enum class Kind {
    line,      ///< through x, y, many of them
    points,    ///< the same with a marker at each
    band,      ///< over x, from `low` to `high`
    level,     ///< all across: a line at y[0], a band from low[0] to high[0]
    steps,     ///< through x, y, level up to the next x
    failures,  ///< above the panel, at each x: `low` of `high` runs failed; without x: of a level
    box,       ///< lying, at height x[0]: quartiles, median, all of the values y
    cells,     ///< around x, y: coloured by the ratio in `low`, white where it is 1, which is written in them
  };
  Kind kind;
  std::size_t series;
  std::vector<double> x, y = {}, low = {}, high = {};  ///< as long as x, where they are used; of a box y has any length
};

struct PanelAxis {
  std::string label;  ///< with its unit
  bool log = false;
  bool share = false;             ///< from 0 to 1
  std::vector<double> ends = {};  ///< numbers that stand below it whatever others do: its first and its last value
};

/// A pair of axes with what is drawn in it.
struct Panel {
  PanelAxis x, y;
  std::vector<Mark> marks;
  std::vector<std::string> names = {};  ///< of boxes, from above, instead of a y axis
  bool equal = false;                   ///< a metre is as long on both axes
  std::string title = {};               ///< above it
};

/// A figure for a page, made of panels in rows.
struct Figure {
  std::vector<Series> series;
  std::vector<Panel> panels;
  std::string caption;                    ///< what it is of, and the protocol, small below
  std::vector<std::string> remarks = {};  ///< for who draws it: what may not be as expected
  std::size_t columns = 1;
  bool legend = true;
  bool alike = false;  ///< a metre is as long in all panels: on both axes where that is `equal`, else on the y axis
  double width_mm = 174.0, height_mm = 64.0;  ///< of the whole; of the panels alone, names being of one line each
};

/// The program that draws it: a Python script that needs matplotlib alone, with all data in it
/// (bench/figures/figure.py). Its arguments are the files to write, .svg, .pdf or .png.
std::string drawing_script(const Figure& figure);

/// Throws InputError for the name of a file that figures can't be written to: no .svg, .pdf or .png.
void check_figure_name(const std::string& file);

/// Draws it to a file. `python`: the interpreter; empty: the first of "python3" and "/usr/bin/python3" that has
/// matplotlib. Throws InputError, with what Python said, where there is none or drawing fails, OutputError where the
/// file can't be written. The file appears complete or not at all; the same figure gives the same bytes by the same
/// matplotlib. Returns what Python warned of, lines that each begin with a newline: the file is there, but may not look
/// as it should.
std::string draw(const Figure& figure, const std::string& file, const std::string& python);

}  // namespace evbench
