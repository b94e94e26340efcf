#include "bench/render/time_label.hpp"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

namespace evbench {

void draw_time(std::int64_t t, const Palette& palette, Picture& picture) {
  constexpr int kMargin = 8;  // [px]
  const std::string text = fmt::format("{:.6f} s", static_cast<double>(t) * 1e-6);
  const Colour ink = Colour::all(255) - palette.background;
  // Rimmed with the background, so that it stands out from the events.
  for (const bool rim : {true, false}) {
    cv::putText(picture, text, {kMargin, picture.rows - kMargin}, cv::FONT_HERSHEY_SIMPLEX, 0.5,
                cv::Scalar(rim ? palette.background : ink), rim ? 4 : 1, cv::LINE_AA);
  }
}

}  // namespace evbench
