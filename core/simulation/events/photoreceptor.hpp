#pragma once

#include <memory>
#include <vector>

#include "core/simulation/events/brightness.hpp"

namespace evbench {

/// What a pixel's photoreceptor makes of a brightness: a low pass of first order, whose bandwidth is proportional to
/// the light (Lichtsteiner et al. 2008; with a floor of a tenth, as Hu et al. 2021 have it). In the dark, events are
/// late and contrast that passes fast is lost.
class Photoreceptor : public Brightness {
 public:
  /// `bandwidth`: cut-off frequency at intensity 1 [Hz].
  Photoreceptor(std::unique_ptr<Brightness> light, double bandwidth);

  int width() const override { return light_->width(); }
  int height() const override { return light_->height(); }
  void start(double t) override;
  double advance(double limit) override;
  double displacement() const override { return light_->displacement(); }
  std::span<const float> image() const override { return image_; }
  float within(int x, int y, int part) const override;

 private:
  std::unique_ptr<Brightness> light_;
  float rate_;                       ///< 1 / time constant at intensity 1 [1/s]
  float length_ = 0.0F;              ///< of the interval [s]
  double t_ = 0.0;                   ///< its end [s]
  std::vector<float> last_light_;    ///< at the interval's beginning
  std::vector<float> last_, image_;  ///< the low pass at its beginning and its end
};

}  // namespace evbench
