#include "core/features/detection.hpp"

#include <algorithm>
#include <functional>
#include <opencv2/imgproc.hpp>

namespace evbench {
namespace {

struct Peak {
  float score;
  int x, y;
};

cv::Mat count_events(std::span<const Event> events, int width, int height) {
  constexpr float kMost = 5.0F;  // a pixel that fires all the time is no feature
  cv::Mat counts = cv::Mat::zeros(height, width, CV_32F);
  for (const Event& event : events) {
    float& count = counts.at<float>(event.y, event.x);
    count = std::min(count + 1.0F, kMost);
  }
  return counts;
}

/// How good a feature each pixel is.
cv::Mat measure(const cv::Mat& counts, DetectionOptions::Method method) {
  constexpr double kSmoothing = 1.0, kNeighbourhood = 5.0;  // [px] standard deviations
  constexpr int kWindow = 7, kSobel = 3;                    // [px]
  const bool corners = method == DetectionOptions::Method::corners;
  cv::Mat image, result;
  cv::GaussianBlur(counts, image, {}, corners ? kSmoothing : kNeighbourhood);
  if (!corners) return image;
  cv::cornerMinEigenVal(image, result, kWindow, kSobel);
  return result;
}

/// Best ones first.
std::vector<Peak> find_peaks(const cv::Mat& score, double quality, int border) {
  double best = 0.0;
  cv::minMaxLoc(score, nullptr, &best);
  const auto least = static_cast<float>(quality * best);
  cv::Mat highest;
  cv::dilate(score, highest, cv::Mat::ones(3, 3, CV_8U));
  std::vector<Peak> peaks;
  for (int y = border; y < score.rows - border; ++y) {
    for (int x = border; x < score.cols - border; ++x) {
      const float here = score.at<float>(y, x);
      if (here > 0.0F && here >= least && here == highest.at<float>(y, x)) peaks.push_back({here, x, y});
    }
  }
  std::ranges::stable_sort(peaks, std::greater<>(), &Peak::score);
  return peaks;
}

}  // namespace

void DetectionOptions::declare(OptionSet& set) {
  set.add("method", method, {"corners", "histogram"},
          "corners: of the image of the newest events (Shi and Tomasi 1994); histogram: where most of them are (Liu et "
          "al. 2022)");
  set.add("events", events, "number of newest events in that image").range(100, 10'000'000);
  set.add("interval", interval, "time between two detections, where features are missing [s]").above(0.0);
  set.add("distance", distance, "smallest distance of new features from one another and from tracked ones [px]")
      .range(1.0, 1000.0);
  set.add("quality", quality, "smallest quality of a feature, as a share of the best one's corner measure or count")
      .range(0.0, 1.0);
  set.add("border", border, "smallest distance of a feature from the image's border [px]").range(0.0, 1000.0);
}

std::vector<Vector2> detect_features(const DetectionOptions& options, std::span<const Event> events, int width,
                                     int height, std::span<const Vector2> taken, std::size_t count) {
  constexpr int kParts = 4;  // along each axis
  std::vector<Vector2> result;
  if (count == 0 || events.empty()) return result;
  const cv::Mat score = measure(count_events(events, width, height), options.method);

  const auto part_of = [&](const Vector2& p) {
    const auto part = [](double x, int size) { return std::clamp(static_cast<int>(kParts * x / size), 0, kParts - 1); };
    return static_cast<std::size_t>(part(p.y(), height) * kParts + part(p.x(), width));
  };
  std::vector<std::size_t> in_part(kParts * kParts, 0);
  for (const Vector2& p : taken) ++in_part[part_of(p)];
  const std::size_t most_in_part = 2 * (taken.size() + count) / in_part.size() + 1;
  for (const Peak& peak : find_peaks(score, options.quality, static_cast<int>(options.border))) {
    if (result.size() == count) break;
    const Vector2 p(peak.x, peak.y);
    const auto is_near = [&](const Vector2& q) { return (p - q).norm() < options.distance; };
    std::size_t& here = in_part[part_of(p)];
    if (here >= most_in_part || std::ranges::any_of(taken, is_near) || std::ranges::any_of(result, is_near)) continue;
    ++here;
    result.push_back(p);
  }
  return result;
}

}  // namespace evbench
