#include "lib/render/still_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "lib/core/parallel_each.h"
#include "lib/render/known_light.h"
#include "lib/render/layer_channels.h"
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

PathParts difference_of(PathParts now, const PathParts& before) {
  for (Layers PathParts::*part : {&PathParts::own, &PathParts::lit, &PathParts::onward})
    add(before.*part, -1, now.*part);
  now.stored_noise.caustic += before.stored_noise.caustic * -1.0f;
  now.stored_noise.indirect += before.stored_noise.indirect * -1.0f;
  return now;
}

/// The part of a mean over `counts` samples that comes from one of them.
Layers part_of_mean(const PathParts& sample, const PartCounts& counts) {
  Layers part;
  add(sample.own, 1 / float(counts.own), part);
  if (counts.lit > 0) add(sample.lit, 1 / float(counts.lit), part);
  if (counts.onward > 0) add(sample.onward, 1 / float(counts.onward), part);
  return part;
}

/// The sample with the largest part in the mean difference of a pixel.
struct StrongestSample {
  /// Its part of the mean over the pass, times the camera rays of the pass. Parts with fewer samples have more weight.
  Layers change;
  double size = 0;  ///< |radiance| of `change` [W/m^2/sr]
  void note(const PathParts& sample, const PartCounts& counts) {
    const Layers part = part_of_mean(sample, counts);
    const double of_sample = std::abs(radiance_of(part)) * counts.own;
    if (!(of_sample > size)) return;
    change = {};
    add(part, float(counts.own), change);
    size = of_sample;
  }
  /// Its part of the mean over `count` samples, minus the mean part of the other samples.
  Layers excess(const Layers& mean, int count) const {
    Layers excess;
    if (count < 2 || !(size > 0)) return excess;
    const float others = 1 / float(count - 1);
    add(change, (1 + others) / float(count), excess);  // minus the mean of the others, (mean - one) / (n - 1)
    add(mean, -others, excess);
    return excess;
  }
};

/// Samples of both moments with the same random numbers.
struct BothMoments {
  const CameraSampler& now;
  const CameraSampler& before;
};

/// Takes the samples of a pass at both moments. Calls add(i, now, change) for each, and adds the changes to `halves`,
/// unless it is null.
template <class Add>
void for_each_change(const BothMoments& moments, const PixelPass& pass, SampleHalves* halves, RayCounts& counts,
                     const Add& add) {
  thread_local std::vector<PathParts> samples;
  samples.clear();
  for_each_sample(moments.now, pass, nullptr, counts, [&](int, const PathParts& sample) { samples.push_back(sample); });
  const Dealt dealt(moments.now.seed, pass.pixel, pass.first, pass.count);
  for_each_sample(moments.before, pass, nullptr, counts, [&](int i, const PathParts& sample) {
    const PathParts change = difference_of(samples[std::size_t(i)], sample);
    if (halves) add_to_half(pass, i, change, dealt(i), *halves);
    add(i, samples[std::size_t(i)], change);
  });
}

/// The layers of a pixel of an image. If the image has no layers, its light counts as layer direct.
class ShownLayers {
 public:
  explicit ShownLayers(const Image& image) : from_(layer_channels(image)) {
    const bool any = std::ranges::any_of(from_, [](const auto& layer) { return layer[0] || layer[1] || layer[2]; });
    if (!any) from_[std::size_t(Layer::direct)] = channels_of(image, "");
  }
  Layers at(std::size_t pixel) const {
    Layers layers;
    for (std::size_t l = 0; l < kLayerCount; ++l)
      for (std::size_t c = 0; c < 3; ++c)
        if (from_[l][c]) layers.value[l][int(c)] = from_[l][c][pixel];
    return layers;
  }

 private:
  std::array<std::array<const float*, 3>, kLayerCount> from_;
};

/// Each first sample of a comparison is two samples, and most pixels need no further ones. So a pixel gets half as many
/// as in a plain frame, and at least one for each half.
FrameOptions with_fewer_first_samples(FrameOptions options) {
  options.samples = std::max(2, options.samples / 2);
  return options;
}

/// Coordinate in a frame of `full` pixels of pixel i of a picture that holds `count` of them, in pieces of
/// kPixelsOfPiece neighbours. The frame itself is one piece.
int place(int i, int count, int full) {
  if (count == full) return i;
  const int piece = i / kPixelsOfPiece, pieces = (count + kPixelsOfPiece - 1) / kPixelsOfPiece;
  const int first = int((2 * std::int64_t(piece) + 1) * full / (2 * pieces)) - kPixelsOfPiece / 2;
  return std::clamp(first + i % kPixelsOfPiece, 0, full - 1);
}

/// A comparison of two moments: choose() first, then the others in their order.
class Comparison {
 public:
  /// Compares the pixels of a frame at `pieces` (still_work).
  Comparison(const CameraSampler& now, const CameraSampler& before, const CameraView& pieces,
             const FrameOptions& options, StillPixels& still)
      : view_(pieces),
        width_(view_.width()),
        height_(view_.height()),
        moments_{now, before},
        options_(with_fewer_first_samples(options)),
        change_noise_(view_, options_),
        plain_noise_(view_, options_),
        still_(still),
        counts_(std::size_t(width_) * std::size_t(height_), change_noise_.first()),
        parts_(counts_.size()),
        strongest_(counts_.size()) {
    still.anew.assign(counts_.size(), 1);
    LayerImage& change = still.change;
    change.width = width_, change.height = height_;
    change.media = now.scene.frame().media != nullptr;
    change.pixels.resize(counts_.size());
    if (options.known && options.known->has_noise()) change.stored_noise.resize(counts_.size());
    if (options.sample_halves) change.sample_halves.resize(counts_.size());
  }

  /// Leaves out the part onward of all samples.
  void leave_out_onward() { onward_ = false; }

  /// Takes the first samples of all pixels, and decides which pixels are kept. Returns the work of the frame over the
  /// work of a frame that keeps no pixels.
  double choose() {
    const PartCounts first = change_noise_.first();
    for_each_pixel(view_, {}, still_.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
      take(pass_at(pixel, x, y, {}, first), counts);
    });
    change_noise_.all_noted();
    plain_noise_.all_noted();
    kept_.resize(still_.anew.size());
    struct Work {
      double with = 0, without = 0;
      Work& operator+=(const Work& o) { return with += o.with, without += o.without, *this; }
    };
    const Work work = parallel_sum<Work>(still_.anew.size(), 1024, [&](std::size_t pixel, Work& sum) {
      const int x = x_of(pixel), y = y_of(pixel);
      const double of_first = 2 * plain_noise_.cost_at(x, y, first),
                   of_changes = 2 * plain_noise_.cost_at(x, y, missing_changes(pixel)),
                   of_all = plain_noise_.cost_at(x, y, plain_noise_.wanted_at(x, y, 1));
      kept_[pixel] = of_changes <= of_all;
      still_.anew[pixel] = !kept_[pixel];
      sum += {of_first + std::min(of_changes, of_all), of_all};
    });
    return work.without > 0 ? work.with / work.without : 1;
  }

  /// Takes the further differences of kept pixels.
  void take_further() {
    for_each_pixel(view_, kept_, still_.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
      const PartCounts have = counts_[pixel], more = missing_changes(pixel);
      if (more.own == 0) return;
      take(pass_at(pixel, x, y, have, more), counts);
      counts_[pixel] = have + more;
    });
    for (std::size_t pixel = 0; pixel < counts_.size(); ++pixel) still_.samples_per_pixel += counts_[pixel].own;
    still_.samples_per_pixel /= double(counts_.size());
  }

  /// Computes the change of kept pixels from their samples.
  void put_together() {
    parallel_each(counts_.size(), 4096, [&](std::size_t pixel) {
      if (!kept_[pixel]) {
        if (!still_.change.sample_halves.empty()) still_.change.sample_halves[pixel] = {};
        return;
      }
      still_.change.pixels[pixel] = parts_[pixel].sum();
      if (!still_.change.stored_noise.empty()) still_.change.stored_noise[pixel] = parts_[pixel].stored_noise;
    });
    for (std::size_t pixel = 0; pixel < counts_.size(); ++pixel)
      if (kept_[pixel]) spread_strongest(pixel);
  }

  /// Measures the noise of the change by taking the differences of some kept pixels a second time. Stores the noise of
  /// each pixel.
  void measure(const Image& base, std::uint64_t seed) {
    NoiseCheck check(view_, seed, kept_);
    const CameraSampler now = again(moments_.now, check.seed()), before = again(moments_.before, check.seed());
    for_each_pixel(view_, kept_, still_.noise_rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
      const std::uint32_t slot = check.slot(x, y);
      if (slot == kNone) return;
      const PartCounts first = change_noise_.first(), all = counts_[pixel];
      const PartCounts more{all.own - first.own, all.lit - first.lit, all.onward - first.onward};
      for (const PixelPass& pass : {pass_at(pixel, x, y, {}, first), pass_at(pixel, x, y, first, more)}) {
        PixelSum sum;
        for_each_change({now, before}, pass, &check.again_halves(slot), counts,
                        [&](int, const PathParts&, const PathParts& change) { sum.add(change); });
        join_parts(sum, pass.first, pass.count, check.again(slot));
      }
    });
    const ShownLayers shown(base);
    std::vector<Layers> pixels(counts_.size());
    parallel_each(pixels.size(), 4096, [&](std::size_t p) { pixels[p] = shown.at(p) + still_.change.pixels[p]; });
    if (!still_.change.sample_halves.empty())
      still_.change.difference_share =
          check.shares(still_.change.sample_halves, [&](std::size_t p) { return parts_[p].sum(); });
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        if (const std::uint32_t slot = check.slot(x, y); slot != kNone)
          check.again(slot).own += shown.at(std::size_t(y) * std::size_t(width_) + std::size_t(x));
    still_.noise = check.measure(
        pixels, [&](std::size_t p) { return shown.at(p) + parts_[p].sum(); }, still_.change.stored_noise);
    if (still_.change.sample_halves.empty()) return;
    still_.noise_channels.width = width_, still_.noise_channels.height = height_;
    add_variance_channels(still_.change, {"halves", "variance", "diffuse.variance"}, still_.noise_channels);
    still_.change.sample_halves = {};  // half a kilobyte per pixel
  }

 private:
  int x_of(std::size_t pixel) const { return int(pixel % std::size_t(width_)); }
  int y_of(std::size_t pixel) const { return int(pixel / std::size_t(width_)); }
  /// The error that a pixel may have [W/m^2/sr].
  double error_at(double level) const { return plain_noise_.error_at(level); }

  static CameraSampler again(const CameraSampler& sampler, std::uint64_t seed) {
    return {sampler.scene, sampler.view, sampler.known, seed, sampler.shutter};
  }

  PixelPass pass_at(std::size_t pixel, int x, int y, const PartCounts& first, const PartCounts& count) const {
    return {pixel, place(x, width_, moments_.now.view.width()), place(y, height_, moments_.now.view.height()), first,
            count};
  }

  PartCounts missing_changes(std::size_t pixel) const {
    return missing_samples(change_noise_.first(), change_noise_.wanted_at(x_of(pixel), y_of(pixel), 1));
  }

  /// Takes the samples of a pass at both moments. First samples are also noted for the decision.
  void take(const PixelPass& pass, RayCounts& counts) {
    PixelSum now[2], change[2];
    double level = 0;
    const std::uint64_t onward = counts.onward;
    for_each_change(moments_, pass, still_.change.halves_of(pass.pixel), counts,
                    [&](int i, PathParts sample, PathParts changed) {
                      level += radiance_of(part_of_mean(sample, pass.count));
                      if (!onward_) sample.onward = changed.onward = {};
                      now[pass.half(i)].add(sample);
                      change[pass.half(i)].add(changed);
                      strongest_[pass.pixel].note(changed, pass.count);
                    });
    join_parts(change[0] + change[1], pass.first, pass.count, parts_[pass.pixel]);
    if (pass.first.own > 0) return;
    const std::uint64_t of_one_moment = onward_ ? (counts.onward - onward) / 2 : 0;
    plain_noise_.note(pass.pixel, now[0], now[1], of_one_moment);
    change_noise_.note(pass.pixel, change[0], change[1], of_one_moment);
    for (PixelNoise* noise : {&plain_noise_, &change_noise_}) noise->set_level(pass.pixel, level);
  }

  /// Spreads the excess of a pixel's strongest sample, if the pixel may not err by that much, evenly over it and the
  /// kept pixels around, so widely that none gets more than it may err, and at most as far as its samples are noticed.
  void spread_strongest(std::size_t pixel) {
    const Layers excess = strongest_[pixel].excess(parts_[pixel].sum(), counts_[pixel].own);
    const double size = std::abs(radiance_of(excess)), error = error_at(plain_noise_.mean_at(pixel));
    if (!(size > error)) return;
    std::vector<std::size_t> to;
    for (int reach = 1; reach <= PixelNoise::kWide && size > error * double(to.size()); ++reach) {
      to.assign(1, pixel);
      for_each_around(width_, height_, x_of(pixel), y_of(pixel), reach, [&](std::size_t near, int, int) {
        if (kept_[near]) to.push_back(near);
      });
    }
    std::vector<Layers>& pixels = still_.change.pixels;
    add(excess, -1, pixels[pixel]);
    for (const std::size_t near : to) add(excess, 1 / float(to.size()), pixels[near]);
  }

  const CameraView& view_;
  int width_, height_;
  bool onward_ = true;  ///< false: the part onward is left out
  BothMoments moments_;
  const FrameOptions options_;
  PixelNoise change_noise_, plain_noise_;
  StillPixels& still_;
  std::vector<std::uint8_t> kept_;  ///< by pixel
  std::vector<PartCounts> counts_;  ///< by pixel: samples of the change
  std::vector<PathParts> parts_;    ///< by pixel: means over these samples
  std::vector<StrongestSample> strongest_;
};

}  // namespace

double StillPixels::share_anew() const {
  return anew.empty() ? 1 : double(std::ranges::count(anew, 1)) / double(anew.size());
}

double still_work(const CameraSampler& now, const CameraSampler& before, const CameraView& pieces,
                  const FrameOptions& options, bool onward) {
  StillPixels still;
  Comparison comparison(now, before, pieces, options, still);
  if (!onward) comparison.leave_out_onward();
  return comparison.choose();
}

StillPixels still_pixels(const CameraSampler& now, const CameraSampler& before, const Image& base,
                         const FrameOptions& options) {
  StillPixels still;
  Comparison comparison(now, before, now.view, options, still);
  still.work = comparison.choose();
  comparison.take_further();
  comparison.put_together();
  comparison.measure(base, options.seed);
  return still;
}

}  // namespace tempolux
