#include "lib/render/adaptive_frame.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "lib/core/parallel_array.h"
#include "lib/render/pixel_noise.h"

namespace tempolux {
namespace {

/// What further samples for its own sake took from a pixel [W/m^2/sr], to be shared out among its neighbours.
struct Change {
  std::size_t pixel = 0;
  Layers taken;
};

class AdaptiveFrame {
 public:
  AdaptiveFrame(const RenderScene& scene, const CameraView& view, const FrameOptions& options, LayerImage& image)
      : scene_(scene), view_(view), options_(options), image_(image), controlled_(options.diffuse_light && scene.lights.has_large()),
        scene_size_(scene.frame().bounds.diagonal()), pixels_(image.pixels.size()), noise_(view, options, controlled_, pixels_) {}

  void first_samples(RayCounts& rays) {
    for_each_tile(view_, options_, rays, {}, [&](RayCounts& counts) {
      return [&, sparse = SparseCaustics()](std::size_t pixel, int x, int y) mutable { first_samples(pixel, x, y, sparse, counts); };
    });
  }

  /// Returns how many.
  double further_samples(RayCounts& rays) {
    const std::vector<int> missing = noise_.missing_samples();
    for_each_tile(view_, options_, rays, options_.progress, [&](RayCounts& counts) {
      return [&, sparse = SparseCaustics()](std::size_t pixel, int x, int y) mutable {
        PixelState& state = pixels_[pixel];
        const int count = missing[pixel], taken = options_.samples + count;
        PixelSum sum;
        if (count > 0) sum = join_further(pixel, x, y, options_.samples, count, sparse, counts);
        if (state.own == 0 && state.lights == 1 && options_.diffuse_light) state.own = noise_.spot_samples(pixel, x, y, sum, taken);
        const float seen = controlled_ ? noise_.seen_around(x, y) : 0;
        Layers& layers = image_.pixels[pixel];
        if (state.own == 0) return take_noise_out(state, seen, taken, layers);
        Layers unchanged = layers;
        take_noise_out(state, seen, taken, unchanged);
        join_further(pixel, x, y, taken, state.own, sparse, counts);
        take_noise_out(state, seen, taken + state.own, layers);
        note_change(pixel, unchanged);
      };
    });
    double sum = 0;
    for (std::size_t pixel = 0; pixel < missing.size(); ++pixel) sum += missing[pixel] + pixels_[pixel].own;
    share_changes();
    return sum;
  }

 private:
  void first_samples(std::size_t pixel, int x, int y, SparseCaustics& sparse, RayCounts& counts) {
    PixelState& state = pixels_[pixel];
    const int n = options_.samples, a = noise_.first_half(), b = n - a;
    LightControl control[2];
    PixelSum first, second;
    with_light(pixel, sparse, [&](const DiffuseLight* light) {
      for_each_sample(scene_, view_, options_.seed, light, pixel, x, y, 0, n, 1, counts,
                      [&](int s) { return controlled_ ? &control[s < a ? 0 : 1] : nullptr; },
                      [&](int s, std::uint32_t surface, const Layers& sample) {
                        (s < a ? first : second).add(sample);
                        if (SampleHalves* halves = image_.halves_of(pixel)) halves->add(s, n, sample);
                        if (s == 0) state.surface = surface;
                      });
    });
    join(first, 0, a, image_.pixels[pixel]);
    if (b > 0) join(second, a, b, image_.pixels[pixel]);
    state.mean = float((first.value() + second.value()) / n);
    for (const LightControl& c : control) {
      state.add_noise(c);
      state.sampled += c.sampled;
      state.seen += c.seen;
    }
    state.plain = control[0].seen_matte + control[1].seen_matte == n && state.memory[1].surface == kNone;
    const double sharp = first.sharp + second.sharp;
    state.sharp_variance = std::max(0.0, first.sharp_square + second.sharp_square - sharp * sharp / n) / std::max(1, n - 1);
    state.sharp = sharp / n;
    if (b == 0) return;
    const auto noise = [](const LightControl& c) { return double(channel_mean(c.direct)); };
    state.difference = float((first.value() - first.sharp) / a - (second.value() - second.sharp) / b);
    state.noise_difference = float(noise(control[0]) / a - noise(control[1]) / b);
  }

  template <class Body>
  void with_light(std::size_t pixel, SparseCaustics& sparse, const Body& body) {
    if (!options_.diffuse_light) return body(nullptr);
    const PixelLight light(*options_.diffuse_light, pixels_[pixel].memory, sparse, view_, scene_size_);
    body(&light);
  }

  /// `count` samples more, from the one of number `first` on.
  PixelSum join_further(std::size_t pixel, int x, int y, int first, int count, SparseCaustics& sparse, RayCounts& counts) {
    const int lights = pixels_[pixel].lights;
    LightControl control;
    PixelSum sum;
    with_light(pixel, sparse, [&](const DiffuseLight* light) {
      sum = sample_pixel(scene_, view_, options_.seed, light, pixel, x, y, first, count / lights, lights, counts,
                         controlled_ ? &control : nullptr, image_.halves_of(pixel));
      sum.stand_for(lights);
      join(sum, first, count, image_.pixels[pixel]);
    });
    pixels_[pixel].add_noise(control);
    return sum;
  }

  static Rgb without_noise(const Rgb& radiance, const Rgb& noise, float seen, int count) {
    Rgb rest;
    for (int c = 0; c < 3; ++c) rest[c] = std::max(0.0f, radiance[c] - noise[c] * seen / float(count));
    return rest;
  }

  static void take_noise_out(const PixelState& state, float seen, int count, Layers& layers) {
    layers[Layer::direct] = without_noise(layers[Layer::direct], state.direct_noise, seen, count);
    layers[Layer::specular] = without_noise(layers[Layer::specular], state.specular_noise, seen, count);
  }

  void note_change(std::size_t pixel, Layers taken) {
    for (std::size_t l = 0; l < kLayerCount; ++l) taken.value[l] = taken.value[l] - image_.pixels[pixel].value[l];
    const std::lock_guard lock(changes_mutex_);
    changes_.push_back({pixel, taken});
  }

  /// Few pixels have some: one after the other, in an order that does not depend on threads.
  void share_changes() {
    const auto width = std::size_t(view_.width());
    std::sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) { return a.pixel < b.pixel; });
    for (const auto& [pixel, taken] : changes_) {
      const int x = int(pixel % width), y = int(pixel / width);
      const auto heirs = float(noise_.count_heirs(pixel, x, y));
      noise_.for_each_heir(pixel, x, y, [&, taken = &taken](std::size_t at) {
        for (std::size_t l = 0; l < kLayerCount; ++l) {
          Rgb& radiance = image_.pixels[at].value[l];
          for (int c = 0; c < 3; ++c) radiance[c] = std::max(0.0f, radiance[c] + taken->value[l][c] / heirs);
        }
      });
    }
  }

  const RenderScene& scene_;
  const CameraView& view_;
  const FrameOptions& options_;
  LayerImage& image_;
  bool controlled_;
  float scene_size_;
  ParallelArray<PixelState> pixels_;
  PixelNoise noise_;
  std::vector<Change> changes_;
  std::mutex changes_mutex_;
};

}  // namespace

void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options, RenderedFrame& frame) {
  AdaptiveFrame adaptive(scene, view, options, frame.mean);
  adaptive.first_samples(frame.rays);
  const double further = adaptive.further_samples(frame.rays);
  frame.mean.samples = options.samples;
  frame.samples_per_pixel = options.samples + further / double(std::max<std::size_t>(1, frame.mean.pixels.size()));
}

}  // namespace tempolux
