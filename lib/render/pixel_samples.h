// lib/render/pixel_samples.h -- one pixel's samples and their sum; all pixels in parallel.
#pragma once

#include <algorithm>
#include <functional>
#include <mutex>

#include "lib/core/parallel.h"
#include "lib/render/frame_renderer.h"

namespace tempolux {

/// Sums over one pixel's samples.
struct PixelSum {
  LayersT<double> layers;
  double sharp = 0, sharp_square = 0;   ///< what has edges, all layers but direct: mean channel
  bool for_filter = false;              ///< FrameOptions::for_filter: layer specular alone is `sharp`
  void add(const Layers& sample) {
    for (std::size_t l = 0; l < kLayerCount; ++l) layers.value[l] += Rgbd(sample.value[l]);
    layers.coverage += double(sample.coverage);
    const Rgb s = for_filter ? sample[Layer::specular]
                             : sample[Layer::emission] + sample[Layer::specular] + sample[Layer::caustic] + sample[Layer::indirect] +
                                   sample[Layer::volume];
    const double v = channel_mean(Rgbd(s));
    sharp += v;
    sharp_square += v * v;
  }
  /// Mean channel of all layers.
  double value() const {
    double sum = 0;
    for (const Rgbd& radiance : layers.value) sum += channel_mean(radiance);
    return sum;
  }
};

/// Joins the sum over samples first .. first+count-1 to the mean over the first `first`.
inline void join(const PixelSum& sum, int first, int count, Layers& mean) {
  const double old_weight = double(first) / (first + count), new_weight = 1.0 / (first + count);
  for (std::size_t l = 0; l < kLayerCount; ++l)
    mean.value[l] = Rgb(Rgbd(mean.value[l]) * old_weight + sum.layers.value[l] * new_weight);
  mean.coverage = float(double(mean.coverage) * old_weight + sum.layers.coverage * new_weight);
}

/// Runs body(pixel, x, y) for every pixel, row by row of a tile, tiles in parallel; each has a body = make_body(counts) of its own.
template <class MakeBody>
void for_each_tile(const CameraView& view, const FrameOptions& options, RayCounts& rays,
                   const std::function<void(double)>& progress, const MakeBody& make_body) {
  constexpr int kTile = 16;
  const int tiles_x = (view.width() + kTile - 1) / kTile, tiles = tiles_x * ((view.height() + kTile - 1) / kTile);
  std::mutex mutex;
  int done = 0;
  parallel_chunks(std::size_t(tiles), 1, [&](std::size_t tile, std::size_t) {
    RayCounts counts;
    auto body = make_body(counts);
    const int x0 = int(tile) % tiles_x * kTile, y0 = int(tile) / tiles_x * kTile;
    for (int y = y0; y < std::min(y0 + kTile, view.height()); ++y)
      for (int x = x0; x < std::min(x0 + kTile, view.width()); ++x) {
        const std::size_t pixel = std::size_t(y) * std::size_t(view.width()) + std::size_t(x);
        if (options.mask.empty() || options.mask[pixel]) body(pixel, x, y);
      }
    const std::lock_guard lock(mutex);
    rays += counts;
    if (progress) progress(double(++done) / tiles);
  });
}

/// Runs body(pixel, x, y, counts) for every pixel, tile by tile in parallel.
template <class Body>
void for_each_pixel(const CameraView& view, const FrameOptions& options, RayCounts& rays, const std::function<void(double)>& progress,
                    const Body& body) {
  for_each_tile(view, options, rays, progress,
                [&](RayCounts& counts) { return [&](std::size_t pixel, int x, int y) { body(pixel, x, y, counts); }; });
}

/// Samples [first, first + count) of a pixel, one after the other: add(sample, radiance). halves: SampleHalves of the pixel, or nullptr.
template <class Add>
void for_each_sample(const RenderScene& scene, const CameraView& view, std::uint64_t seed, const KnownLight* known,
                     std::size_t pixel, int x, int y, int first, int count, SampleHalves* halves, RayCounts& counts, const Add& add) {
  constexpr int kTogether = 8, kFewest = 3;   // rays of a pixel go nearly the same way: from three on a packet pays
  for (int done = 0; done < count; done += kTogether) {
    const int n = std::min(kTogether, count - done);
    Ray rays[kTogether];
    Hit hits[kTogether];
    const PixelRandom random(seed, pixel, 0);
    const auto of = [&](int i) { return random.of_sample(std::uint32_t(first + done + i)); };
    for (int i = 0; i < n; ++i) {
      const Vec2 jitter = of(i).get2(0, Purpose::pixel);
      rays[i] = view.ray(float(x) + jitter.x, float(y) + jitter.y);
    }
    if (n < kFewest)
      for (int i = 0; i < n; ++i) scene.tracer.intersect(rays[i], hits[i]);
    else
      scene.tracer.intersect({rays, std::size_t(n)}, {hits, std::size_t(n)});
    for (int i = 0; i < n; ++i) {
      const Layers layers = trace_eye_path(scene, rays[i], hits[i], of(i), known, counts, view.cone());
      if (halves) halves->add(done + i, count, layers);
      add(first + done + i, layers);
    }
  }
}

inline PixelSum sample_pixel(const RenderScene& scene, const CameraView& view, std::uint64_t seed, const KnownLight* known,
                             std::size_t pixel, int x, int y, int first, int count, SampleHalves* halves, RayCounts& counts) {
  PixelSum sum;
  for_each_sample(scene, view, seed, known, pixel, x, y, first, count, halves, counts,
                  [&](int, const Layers& sample) { sum.add(sample); });
  return sum;
}

}  // namespace tempolux
