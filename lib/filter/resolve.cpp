#include "lib/filter/resolve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/filter/rows.h"

namespace tempolux {
namespace {

constexpr int kNear = 2;                  ///< pixels
constexpr float kStratified = 5.0f / 3;   ///< samples of a pixel are stratified: their mean's variance falls as n^(-5/3) (docs/pixels.md)

/// The formula of resolve() at a pixel that sees several surfaces. own(x, y), other: radiance of surfaces.
template <class Own>
float composed(const Own& own, float other, const Coverage& coverage, int x, int y, int width, int height) {
  const float unknown = coverage.other(x, y);
  float sum = unknown * other, rest = 1 - unknown;
  coverage.for_each_share(x, y, [&](int dx, int dy, float share) {
    if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) return;
    sum += share * own(x + dx, y + dy);
    rest -= share;
  });
  return sum + std::max(rest, 0.0f) * own(x, y);
}

/// What passes the filter at the pixels that are not inside surfaces.
class Passing {
 public:
  Passing(const LightFrame& frame, const Coverage& coverage, const Channel* samples) : frame_(frame), coverage_(coverage), samples_(samples) {
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x)
        if (frame.inside.at(x, y) == 0) edges_.emplace_back(x, y);
    own_ = Plane(frame.width, frame.height);
    resolved_.resize(edges_.size());
  }

  void resolve(std::vector<float>& values) {
    own_.take(values, frame_.width);
    for_each_edge([&](std::size_t, int x, int y) { own_.at(x, y) = of_surface(x, y); });   // reads pixels inside, writes others
    const auto own = [&](int x, int y) { return own_.at(x, y); };
    for_each_edge([&](std::size_t e, int x, int y) {
      const float by_coverage = composed(own, own_.at(x, y), coverage_, x, y, frame_.width, frame_.height), value = values[index(x, y)];
      const float n = samples_ ? samples_->values[index(x, y)] : 1;
      resolved_[e] = by_coverage;
      if (!(n > 1)) return;   // the value may be no number
      const float ratio = std::pow((n - 1) / float(Coverage::kRays), kStratified);
      resolved_[e] += ratio / (1 + ratio) * (value - by_coverage);
    });
    for_each_edge([&](std::size_t e, int x, int y) {
      float& value = values[index(x, y)];
      if (!is_too_bright(value)) value = resolved_[e];
    });
  }

 private:
  template <class Body>
  void for_each_edge(const Body& body) const {
    parallel_chunks(edges_.size(), 1024, [&](std::size_t first, std::size_t last) {
      for (std::size_t e = first; e < last; ++e) body(e, edges_[e].first, edges_[e].second);
    });
  }
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(frame_.width) + std::size_t(x); }
  /// Mean over inside pixels of the surface nearby.
  float of_surface(int x, int y) const {
    float sum = 0, count = 0;
    for (int dy = -kNear; dy <= kNear; ++dy)
      for (int dx = -kNear; dx <= kNear; ++dx)
        if (frame_.has_pixel(x + dx, y + dy) && frame_.inside.at(x + dx, y + dy) != 0 && frame_.on_surface(x, y, dx, dy)) {
          sum += own_.at(x + dx, y + dy);
          count += 1;
        }
    return count > 0 ? sum / count : own_.at(x, y);
  }

  const LightFrame& frame_;
  const Coverage& coverage_;
  const Channel* samples_;
  std::vector<std::pair<int, int>> edges_;
  Plane own_;
  std::vector<float> resolved_;
};

}  // namespace

bool is_too_bright(float value) { return std::isfinite(value) && !(std::abs(value) < kLargestLight); }

void resolve(const EdgePlane& light, const Coverage& coverage, int width, int height, std::vector<float>& values) {
  const auto own = [&](int x, int y) { return light.own_at(x, y); };
  for_each_row(height, [&](int y) {
    float* to = values.data() + std::size_t(y) * std::size_t(width);
    for (int x = 0; x < width; ++x) {
      if (is_too_bright(to[x])) continue;
      to[x] = coverage.is_whole(x, y) ? light.own_at(x, y) : composed(own, light.other_at(x, y), coverage, x, y, width, height);
    }
  });
}

void resolve_passing(const LightFrame& frame, const Coverage& coverage, Image& image) {
  const Channel* samples = image.find("samples");
  Passing passing(frame, coverage, samples && !samples->values.empty() ? samples : nullptr);
  for (const char* name : {"emission.R", "emission.G", "emission.B", "specular.R", "specular.G", "specular.B", "A"})
    if (Channel* channel = image.find(name); channel && !channel->values.empty()) passing.resolve(channel->values);
}

}  // namespace tempolux
