#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/figures/figure_runs.hpp"

namespace evbench {

Figure box_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  const FigureRuns all(runs, options.online);
  const std::vector<Metric> metrics = all.metrics(options);
  Figure figure;
  figure.legend = false;
  for (const Method& method : all.methods) figure.series.push_back({method.name});
  for (const Metric& metric : metrics) {
    Panel panel{{metric.header}, {}, {}};
    std::vector<double> drawn;
    for (std::size_t m = 0; m < all.methods.size(); ++m) {
      std::vector<double> values = values_of(all.methods[m].runs, all.runs, metric);
      const std::size_t counted = values.size();
      std::erase_if(values, [](double value) { return std::isinf(value); });
      for (double& value : values) value *= metric.factor;
      const bool some_failed = values.size() < counted;
      // Once a row: panels that stand side by side share their names.
      panel.names.push_back(
          !figure.panels.empty() && !some_failed ? ""
          : some_failed ? fmt::format("{} ({} of {} fail)", all.methods[m].name, counted - values.size(), counted)
                        : all.methods[m].name);
      drawn.insert(drawn.end(), values.begin(), values.end());
      if (!values.empty()) panel.marks.push_back({Mark::Kind::box, m, {static_cast<double>(m)}, std::move(values)});
    }
    panel.x.log = spread_wide(drawn);
    figure.panels.push_back(std::move(panel));
  }
  figure.columns = figure.panels.size();
  figure.height_mm = 13.0 + 6.5 * static_cast<double>(all.methods.size());
  figure.caption = all.scored_caption("Boxes between quartiles, with the median; each run is a point.", options.online);
  return figure;
}

}  // namespace evbench
