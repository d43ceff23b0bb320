// lib/render/pixel_samples.h -- the samples of one pixel and their sum; loops over all pixels in parallel.
#pragma once

#include <algorithm>
#include <functional>
#include <mutex>
#include <span>

#include "lib/core/parallel.h"
#include "lib/render/frame_renderer.h"
#include "lib/render/photon_light.h"
#include "lib/render/shutter.h"

namespace tempolux {

/// Numbers of samples of each part (PathParts). `own` is the number of camera rays.
struct PartCounts {
  int own = 0, lit = 0, onward = 0;
  PartCounts operator+(const PartCounts& o) const { return {own + o.own, lit + o.lit, onward + o.onward}; }
};

/// Numbers of further samples that a pixel with `have` samples needs to reach `wanted`. Samples of the parts lit and
/// onward start from camera rays, so they need further camera rays, too.
inline PartCounts missing_samples(const PartCounts& have, const PartCounts& wanted) {
  // At most two samples of each part per camera ray: samples at one place miss the differences between the places of a
  // pixel, such as edges of shadows and folds.
  constexpr int kMostPerRay = 2;
  const auto further = [](int has, int wants) { return std::max(0, wants - has); };
  PartCounts more{further(have.own, wanted.own), further(have.lit, wanted.lit), further(have.onward, wanted.onward)};
  more.own = std::max(more.own, (std::max(more.lit, more.onward) + kMostPerRay - 1) / kMostPerRay);
  return more;
}

/// Sums over samples of one pixel.
struct PixelSum {
  LayersT<double> own, lit, onward;
  StoredNoiseT<double> stored_noise;
  /// Sums over samples of the squares of seen(own), specular(own) and radiance_of(onward).
  double seen_square = 0, specular_square = 0, onward_square = 0;
  void add(const PathParts& sample) {
    own += sample.own;
    lit += sample.lit;
    onward += sample.onward;
    stored_noise += sample.stored_noise;
    const auto square = [](double v) { return v * v; };
    seen_square += square(seen(sample.own));
    specular_square += square(specular(sample.own));
    onward_square += square(radiance_of(sample.onward));
  }
  /// The sum of the parts and the noise; the squares are not added.
  PixelSum operator+(const PixelSum& more) const {
    PixelSum sum = *this;
    sum.stored_noise += more.stored_noise;
    for (LayersT<double> PixelSum::*part : {&PixelSum::own, &PixelSum::lit, &PixelSum::onward}) sum.*part += more.*part;
    return sum;
  }
  /// Mean channel of layer specular.
  template <class T>
  static double specular(const LayersT<T>& layers) {
    return channel_mean(Rgbd(layers[Layer::specular]));
  }
  /// Mean channel of the other layers.
  template <class T>
  static double seen(const LayersT<T>& layers) {
    return radiance_of(layers) - specular(layers);
  }
};

/// Changes `mean`, the mean over `first` samples, to the mean over these samples and `count` further samples. `sum`:
/// the sum of the further samples.
inline void join(const LayersT<double>& sum, int first, int count, Layers& mean) {
  if (count == 0) return;
  const double old_weight = double(first) / (first + count), new_weight = 1.0 / (first + count);
  for (std::size_t l = 0; l < kLayerCount; ++l)
    mean.value[l] = Rgb(Rgbd(mean.value[l]) * old_weight + sum.value[l] * new_weight);
  mean.coverage = float(double(mean.coverage) * old_weight + sum.coverage * new_weight);
  mean.mirrored = float(double(mean.mirrored) * old_weight + sum.mirrored * new_weight);
}

/// The same for noise of records and photons.
inline void join(const StoredNoiseT<double>& sum, int first, int count, StoredNoise& mean) {
  if (count <= 0) return;
  const auto joined = [&](const Rgb& before, const Rgbd& more) {
    return Rgb((Rgbd(before) * double(first) + more) * (1.0 / (first + count)));
  };
  mean = {joined(mean.caustic, sum.caustic), joined(mean.indirect, sum.indirect)};
}

/// The same for a sum of three parts with `count` samples each.
inline void join(const PixelSum& sum, int first, int count, Layers& mean) {
  join(sum.own + (sum.lit + sum.onward), first, count, mean);
}

/// Joins sums over `count` new samples of each part to `means`, the means over the `first` samples before them.
inline void join_parts(const PixelSum& sum, const PartCounts& first, const PartCounts& count, PathParts& means) {
  join(sum.own, first.own, count.own, means.own);
  join(sum.lit, first.lit, count.lit, means.lit);
  join(sum.onward, first.onward, count.onward, means.onward);
  join(sum.stored_noise, first.own, count.own, means.stored_noise);
}

/// Calls body(pixel, x, y, counts) for each pixel of the mask (empty: for every pixel), row by row within a tile, with
/// tiles in parallel. `rays` receives the sum of the counts. progress(share of the tiles done) may be empty.
template <class Body>
void for_each_pixel(const CameraView& view, std::span<const std::uint8_t> mask, RayCounts& rays,
                    const std::function<void(double)>& progress, const Body& body) {
  constexpr int kTile = 16;
  const int tiles_x = (view.width() + kTile - 1) / kTile, tiles = tiles_x * ((view.height() + kTile - 1) / kTile);
  std::mutex mutex;
  int done = 0;
  parallel_chunks(std::size_t(tiles), 1, [&](std::size_t tile, std::size_t) {
    RayCounts counts;
    const int x0 = int(tile) % tiles_x * kTile, y0 = int(tile) / tiles_x * kTile;
    for (int y = y0; y < std::min(y0 + kTile, view.height()); ++y)
      for (int x = x0; x < std::min(x0 + kTile, view.width()); ++x) {
        const std::size_t pixel = std::size_t(y) * std::size_t(view.width()) + std::size_t(x);
        if (mask.empty() || mask[pixel]) body(pixel, x, y, counts);
      }
    const std::lock_guard lock(mutex);
    rays += counts;
    if (progress) progress(double(++done) / tiles);
  });
}

/// Distributes samples of the parts lit and onward over a pixel's camera rays, as uniformly as whole numbers allow. A
/// random offset for each part makes all camera rays equally likely to get a sample, so the mean over the samples of a
/// part is unbiased for any number of them.
class Dealt {
 public:
  Dealt(std::uint64_t seed, std::uint64_t pixel, const PartCounts& first, const PartCounts& counts)
      : first_(first), counts_(counts), offset_(PathRandom(seed ^ 0x6465616c74ull, pixel).get2(0, Purpose::pixel)) {}
  /// Effort of camera ray i of counts.own. Samples are numbered from `first` on.
  PathEffort operator()(int i) const {
    const std::uint32_t lit = before(i, counts_.lit, offset_.x), onward = before(i, counts_.onward, offset_.y);
    return {before(i + 1, counts_.lit, offset_.x) - lit, before(i + 1, counts_.onward, offset_.y) - onward,
            std::uint32_t(first_.lit) + lit, std::uint32_t(first_.onward) + onward};
  }

 private:
  std::uint32_t before(int i, int count, float offset) const {
    return std::uint32_t(double(i) * count / counts_.own + double(offset));
  }
  PartCounts first_, counts_;
  Vec2 offset_;
};

/// From where samples of pixels are taken. All members must outlive it.
struct CameraSampler {
  const RenderScene& scene;
  const CameraView& view;
  const KnownLight* known;  ///< light at which camera paths may end; or null
  std::uint64_t seed;
  const Shutter* shutter = nullptr;  ///< of motion blur; null: all samples see one moment
};

/// A pixel and the samples that one pass takes of it: `count` samples, which continue the pixel's Sobol sequences after
/// `first` samples. The first half of a pass belongs to one half of the pixel's samples, the second half to the other:
/// consecutive samples are well stratified.
struct PixelPass {
  std::size_t pixel;
  int x, y;
  PartCounts first, count;

  /// The half (0 or 1) of the pass to which its sample i belongs.
  int half(int i) const { return 2 * i >= count.own; }
};

/// Adds sample i of a pass to its half. The sample of a pass of one goes to the half that has fewer.
inline void add_to_half(const PixelPass& pass, int i, const PathParts& sample, const PathEffort& effort,
                        SampleHalves& halves) {
  const bool single = pass.count.own == 1;
  halves.add(single ? halves.half[1][0].count < halves.half[0][0].count : pass.half(i), sample, effort);
}

/// Takes the samples of a pass one after the other and calls add(i, sample). Also adds them to `halves`, unless it is
/// null.
template <class Add>
void for_each_sample(const CameraSampler& camera, const PixelPass& pass, SampleHalves* halves, RayCounts& counts,
                     const Add& add) {
  const KnownLight* const known = camera.known;
  const std::uint64_t seed = camera.seed;
  const PixelRandom of_pixel(seed, pass.pixel, 0);
  const Dealt dealt(seed, pass.pixel, pass.first, pass.count);
  CausticMemory caustics;
  for (int i = 0; i < pass.count.own; ++i) {
    const PixelRandom random = of_pixel.of_sample(std::uint32_t(pass.first.own + i));
    const PathEffort effort = dealt(i);
    const auto [scene, view] = seen_now({camera.scene, camera.view}, camera.shutter, random);
    const Ray ray = view.ray(sample_of_pixel(view, pass.x, pass.y, random));
    Hit hit;
    scene.tracer.intersect(ray, hit);
    caustics.use_half(pass.half(i));
    const PathParts parts = trace_eye_parts(scene, {ray, hit, view.cone()}, random, known, counts, effort);
    if (halves) add_to_half(pass, i, parts, effort, *halves);
    add(i, parts);
  }
}

/// Sum over the samples of a pass.
inline PixelSum sample_pixel(const CameraSampler& camera, const PixelPass& pass, SampleHalves* halves,
                             RayCounts& counts) {
  PixelSum sum;
  for_each_sample(camera, pass, halves, counts, [&](int, const PathParts& sample) { sum.add(sample); });
  return sum;
}

}  // namespace tempolux
