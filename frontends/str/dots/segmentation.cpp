#include "frontends/str/dots/segmentation.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace evbench::str {

void SegmentationOptions::declare(OptionSet& set) {
  set.add("gap", gap, "events this far apart are of one cluster [px]").range(1.0, 50.0);
  set.add("least_events", least_events, "a cluster with fewer events is no dot").range(8);
  set.add("smallest", smallest, "radius of a dot, at least [px]").range(0.5);
  set.add("largest", largest, "radius of a dot, at most [px]").range(0.5);
  set.add("residual", residual, "its events lie off a circle by at most this, root mean square [px]").above(0.0);
  set.add("covered", covered, "share of the rim's eight sectors on which they lie, at least").range(0.0, 1.0);
}

std::vector<Circle> find_circles(const SegmentationOptions& options, std::span<const Vector2> places, int width,
                                 int height) {
  cv::Mat seen = cv::Mat::zeros(height, width, CV_8U), spread, labels;
  const auto pixel_of = [](const Vector2& p) {
    return cv::Point(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  };
  const auto inside = [&](const Vector2& p) {
    return p.x() >= 0.0 && p.y() >= 0.0 && p.x() <= width - 1 && p.y() <= height - 1;
  };
  for (const Vector2& p : places) {
    if (inside(p)) seen.at<std::uint8_t>(pixel_of(p)) = 1;
  }
  const int side = static_cast<int>(std::ceil(options.gap)) | 1;
  cv::dilate(seen, spread, cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side}));
  const int count = cv::connectedComponents(spread, labels);
  std::vector<std::vector<Vector2>> clusters(static_cast<std::size_t>(count));
  for (const Vector2& p : places) {
    if (inside(p)) clusters[static_cast<std::size_t>(labels.at<int>(pixel_of(p)))].push_back(p);
  }
  std::vector<Circle> result;
  for (std::size_t i = 1; i < clusters.size(); ++i) {
    if (clusters[i].size() < static_cast<std::size_t>(options.least_events)) continue;
    const auto fit = fit_circle(clusters[i]);
    if (!fit || fit->residual > options.residual || fit->covered < options.covered) continue;
    const auto& [c, r] = fit->circle;
    if (r < options.smallest || r > options.largest || c.x() - r < 1.0 || c.y() - r < 1.0 || c.x() + r > width - 2 ||
        c.y() + r > height - 2) {
      continue;
    }
    result.push_back(fit->circle);
  }
  return result;
}

}  // namespace evbench::str
