#include "lib/render/still_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "lib/core/parallel_each.h"
#include "lib/render/pixel_noise.h"
#include "lib/render/pixels_around.h"

namespace tempolux {
namespace {

/// Adds `light` times `factor`.
void add(const Layers& light, float factor, Layers& to) {
  for (std::size_t l = 0; l < kLayerCount; ++l) to.value[l] += light.value[l] * factor;
  to.coverage += light.coverage * factor;
  to.mirrored += light.mirrored * factor;
}

PathParts difference(PathParts now, const PathParts& before) {
  for (Layers PathParts::*part : {&PathParts::own, &PathParts::lit, &PathParts::onward})
    add(before.*part, -1, now.*part);
  return now;
}

/// First samples of a pixel at both moments.
struct FirstSamples {
  PixelSum half[2];            ///< of the differences
  double now = 0;              ///< sum of the radiance now
  std::vector<Layers> change;  ///< each sample's part of the mean difference; their sum is the mean
  std::uint64_t onward = 0;
};

FirstSamples first_samples(const CameraSampler& now, const CameraSampler& before, const PixelPass& pass,
                           RayCounts& counts) {
  std::vector<PathParts> samples;
  samples.reserve(std::size_t(pass.count.own));
  FirstSamples first;
  const std::uint64_t onward = counts.onward;
  for_each_sample(now, pass, nullptr, counts, [&](int, const PathParts& sample) { samples.push_back(sample); });
  first.onward = counts.onward - onward;
  for_each_sample(before, pass, nullptr, counts, [&](int i, const PathParts& sample) {
    const PathParts& other = samples[std::size_t(i)];
    const PathParts changed = difference(other, sample);
    first.half[pass.half(i)].add(changed);
    first.now += radiance_of(other.sum());
    Layers& change = first.change.emplace_back();
    add(changed.own, 1 / float(pass.count.own), change);
    add(changed.lit, 1 / float(pass.count.lit), change);
    add(changed.onward, 1 / float(pass.count.onward), change);
  });
  return first;
}

/// The sample that changes a pixel's mean difference most.
struct Lone {
  Layers excess;    ///< its part of the mean difference, minus the mean part of the other samples
  double size = 0;  ///< |radiance| of the excess
};

/// change: of each sample, as FirstSamples has it. sum: over the samples.
Lone lone_of(const std::vector<Layers>& change, const Layers& sum) {
  Lone lone;
  if (change.size() < 2) return lone;
  const float others = 1 / float(change.size() - 1);
  for (const Layers& one : change) {
    Layers excess = one;  // minus the mean of the others, (sum - one) / (n - 1)
    add(one, others, excess);
    add(sum, -others, excess);
    if (const double size = std::abs(radiance_of(excess)); size > lone.size) lone = {excess, size};
  }
  return lone;
}

bool more(const PartCounts& wanted, const PartCounts& first) {
  return wanted.own > first.own || wanted.lit > first.lit || wanted.onward > first.onward;
}

/// A comparison of two moments.
class Comparison {
 public:
  Comparison(const CameraSampler& now, const CameraSampler& before, const FrameOptions& options, StillPixels& still)
      : width_(now.view.width()), height_(now.view.height()), noise_(now.view, options), still_(still) {
    still.anew.assign(std::size_t(width_) * std::size_t(height_), 1);
    still.change.resize(still.anew.size());
    lone_.resize(still.anew.size());
    level_.resize(still.anew.size());
    const PartCounts first = noise_.first();
    for_each_pixel(now.view, {}, still.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
      const FirstSamples samples = first_samples(now, before, {pixel, x, y, {}, first}, counts);
      level_[pixel] = samples.now / first.own;
      noise_.note(pixel, samples.half[0], samples.half[1], samples.onward);
      noise_.set_level(pixel, level_[pixel]);
      for (const Layers& one : samples.change) add(one, 1, still_.change[pixel]);
      lone_[pixel] = lone_of(samples.change, still_.change[pixel]);
    });
    noise_.all_noted();
    parallel_each(still.anew.size(), 1024, [&](std::size_t pixel) {
      still_.anew[pixel] = more(noise_.wanted_at(x_of(pixel), y_of(pixel), 1), first);
    });
  }

  /// Spreads the excess of lone samples.
  void treat_lone_samples() {
    for (std::size_t pixel = 0; pixel < lone_.size(); ++pixel)
      if (!still_.anew[pixel] && lone_[pixel].size > error_at(pixel)) spread_from(pixel);
  }

 private:
  int x_of(std::size_t pixel) const { return int(pixel % std::size_t(width_)); }
  int y_of(std::size_t pixel) const { return int(pixel / std::size_t(width_)); }
  /// The error that a pixel may have [W/m^2/sr].
  double error_at(std::size_t pixel) const { return noise_.error_at(level_[pixel]); }

  /// Spreads the excess of a pixel evenly over it and the kept pixels around, so widely that none gets more than it may
  /// err, and at most as far as its samples are noticed.
  void spread_from(std::size_t pixel) {
    const Lone& lone = lone_[pixel];
    std::vector<std::size_t> to;
    for (int reach = 1; reach <= PixelNoise::kWide && lone.size > error_at(pixel) * double(to.size()); ++reach) {
      to.assign(1, pixel);
      for_each_around(width_, height_, x_of(pixel), y_of(pixel), reach, [&](std::size_t near, int, int) {
        if (!still_.anew[near]) to.push_back(near);
      });
    }
    add(lone.excess, -1, still_.change[pixel]);
    for (const std::size_t near : to) add(lone.excess, 1 / float(to.size()), still_.change[near]);
  }

  int width_, height_;
  PixelNoise noise_;
  StillPixels& still_;
  std::vector<Lone> lone_;
  std::vector<double> level_;  ///< by pixel: radiance now, mean of the channels [W/m^2/sr]
};

}  // namespace

double StillPixels::share_anew() const {
  return anew.empty() ? 1 : double(std::ranges::count(anew, 1)) / double(anew.size());
}

StillPixels still_pixels(const CameraSampler& now, const CameraSampler& before, const FrameOptions& options) {
  StillPixels still;
  Comparison(now, before, options, still).treat_lone_samples();
  return still;
}

void add_change(const StillPixels& still, Image& image) {
  const auto values = [&](const std::string& name) -> float* {
    Channel* channel = image.find(name);
    return channel && channel->ids.empty() ? channel->values.data() : nullptr;
  };
  std::array<std::array<float*, 3>, kLayerCount> layers{};
  std::array<float*, 3> sum{};
  bool all = true;
  for (std::size_t c = 0; c < 3; ++c) {
    sum[c] = values(std::string(1, "RGB"[c]));
    for (std::size_t l = 0; l < kLayerCount; ++l) {
      layers[l][c] = values(std::string(kLayerNames[l]) + "." + "RGB"[c]);
      all &= layers[l][c] != nullptr || l == std::size_t(Layer::volume);
    }
  }
  float* const alpha = values("A");
  parallel_each(still.anew.size(), 4096, [&](std::size_t p) {
    if (still.anew[p]) return;
    const Layers& change = still.change[p];
    for (std::size_t c = 0; c < 3; ++c) {
      float shown = 0;
      for (std::size_t l = 0; l < kLayerCount; ++l) {
        const float by = change.value[l][int(c)];
        if (float* const to = layers[l][c]) to[p] = std::max(0.0f, to[p] + by), shown += to[p];
        if (!all && sum[c]) sum[c][p] += by;
      }
      if (sum[c]) sum[c][p] = all ? shown : std::max(0.0f, sum[c][p]);
    }
    if (alpha) alpha[p] = std::clamp(alpha[p] + change.coverage, 0.0f, 1.0f);
  });
}

}  // namespace tempolux
