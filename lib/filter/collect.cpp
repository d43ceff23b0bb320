#include "lib/filter/collect.h"

#include <algorithm>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr std::size_t kRows = 8;   ///< of a chunk

float square_of_difference(const ColourPlane& a, int ax, int ay, const ColourPlane& b, int bx, int by) {
  float sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float difference = a[c].at(ax, ay) - b[c].at(bx, by);
    sum += difference * difference;
  }
  return sum;
}

float square(const ColourPlane& a, int x, int y) {
  float sum = 0;
  for (const Plane& plane : a) sum += plane.at(x, y) * plane.at(x, y);
  return sum;
}

class Collection {
  using Light = std::array<std::array<float, 3>, kFilteredLayers.size()>;

 public:
  Collection(std::span<const WindowFrame> window, std::size_t middle, std::span<const float> frame_weights, const Plane* in_time, Collected& out)
      : window_(window), middle_(middle), frame_weights_(frame_weights), in_time_(in_time), frame_(*window[middle].light), out_(out) {}

  void pixel(int x, int y) {
    weight_ = mean_weight_ = mean_variance_ = 0;
    edge_weight_ = 0;
    light_ = edge_light_ = {};
    mean_ = {};
    add(frame_, x, y, frame_weight(middle_), 1);
    if (!in_time_ || in_time_->at(x, y) != 0) follow_both(x, y);
    store(x, y);
  }

 private:
  float frame_weight(std::size_t at) const { return frame_weights_.empty() ? 1.0f : frame_weights_[at]; }

  void follow_both(int x, int y) {
    const bool by_value = frame_.noise != NoiseKnowledge::none;
    for (const int direction : {-1, 1})
      follow(window_, middle_, direction, x, y, [&](std::size_t at, int ax, int ay) {
        const LightFrame& other = *window_[at].light;
        float weight = frame_weight(at);
        if (by_value)
          weight *= value_weight(square_of_difference(frame_.mean, x, y, other.mean, ax, ay),
                                 frame_.mean_variance.at(x, y) + other.mean_variance.at(ax, ay) + rounding_variance(square(frame_.mean, x, y)));
        if (weight > 0) add(other, ax, ay, weight, weight);
      });
  }

  void add(const LightFrame& frame, int x, int y, float weight, float mean_weight) {
    for (std::size_t c = 0; c < 3; ++c) mean_[c] += mean_weight * frame.mean[c].at(x, y);
    mean_variance_ += mean_weight * mean_weight * frame.mean_variance.at(x, y);
    mean_weight_ += mean_weight;
    const bool of_use = frame.use.at(x, y) != 0;
    (of_use ? weight_ : edge_weight_) += weight;
    Light& light = of_use ? light_ : edge_light_;
    for (std::size_t l = 0; l < frame.light.size(); ++l)
      for (std::size_t c = 0; c < 3 && !frame.light[l][c].empty(); ++c) light[l][c] += weight * frame.light[l][c].at(x, y);
  }

  void store(int x, int y) {
    const Light& light = weight_ > 0 ? light_ : edge_light_;
    const float weight = weight_ > 0 ? weight_ : edge_weight_;
    out_.weight.at(x, y) = weight_;
    for (std::size_t l = 0; l < frame_.light.size(); ++l)
      for (std::size_t c = 0; c < 3 && !out_.light[l][c].empty(); ++c) out_.light[l][c].at(x, y) = light[l][c] / weight;
    for (std::size_t c = 0; c < 3; ++c) out_.mean[c].at(x, y) = mean_[c] / mean_weight_;
    out_.mean_variance.at(x, y) = mean_variance_ / (mean_weight_ * mean_weight_);
  }

  std::span<const WindowFrame> window_;
  std::size_t middle_;
  std::span<const float> frame_weights_;
  const Plane* in_time_;
  const LightFrame& frame_;
  Collected& out_;
  float weight_ = 0, edge_weight_ = 0, mean_weight_ = 0, mean_variance_ = 0;
  Light light_{}, edge_light_{};   ///< of pixels that are of use, of the others
  std::array<float, 3> mean_{};
};

}  // namespace

Collected collect(std::span<const WindowFrame> window, std::size_t middle, std::span<const float> frame_weights, const Plane* in_time) {
  const LightFrame& frame = *window[middle].light;
  const auto empty = [&] { return Plane(frame.width, frame.height); };
  Collected out;
  out.weight = empty();
  out.mean_variance = empty();
  for (Plane& plane : out.mean) plane = empty();
  out.light.resize(frame.light.size());
  for (std::size_t l = 0; l < out.light.size(); ++l)
    if (std::any_of(window.begin(), window.end(), [&](const WindowFrame& other) { return !other.light->light[l][0].empty(); }))
      for (Plane& plane : out.light[l]) plane = empty();
  parallel_chunks(std::size_t(frame.height), kRows, [&](std::size_t first, std::size_t last) {
    Collection collection(window, middle, frame_weights, in_time, out);
    for (int y = int(first); y < int(last); ++y)
      for (int x = 0; x < frame.width; ++x) collection.pixel(x, y);
  });
  return out;
}

}  // namespace tempolux
