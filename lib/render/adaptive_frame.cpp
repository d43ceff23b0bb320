#include "lib/render/adaptive_frame.h"

#include <algorithm>
#include <cmath>

#include "lib/render/pixel_light.h"
#include "lib/render/pixel_samples.h"

namespace tempolux {
namespace {

/// What is kept of a pixel between its first and its further samples.
struct PixelState {
  PixelLight::Memory memory;
  float mean = 0;                       ///< of the first samples, mean of the channels
  Rgb direct_noise{0.0f}, specular_noise{0.0f};   ///< LightControl, of all samples
  float sampled = 0, seen = 0;          ///< of the first
  bool plain = false;                   ///< the first met one matte surface, controlled
  int lights = 1;                       ///< samples of the lights to a further camera ray
  int own = 0;                          ///< further samples for its own sake
  float heirs = 0;                      ///< neighbours that share what those change
  Rgb change{0.0f};                     ///< ... of the direct layer, W/m^2/sr
  double sharp = 0, sharp_variance = 0; ///< of one of the first: PixelSum::sharp; a square of light may be beyond float
  float difference = 0, noise_difference = 0;     ///< of all else: mean over half of the first samples less that over the others

  void add_noise(const LightControl& more) {
    direct_noise += more.direct;
    specular_noise += more.specular;
  }
};

// Pixels: one is judged by the 24 around it; by 8 for what has edges, which are narrow: all that see one pay for it.
constexpr int kNear = 2, kNearSharp = 1;
constexpr double kBetween = 0.1;
// Samples that are stratified err as n^(-5/6) or so. The least error for a number of samples has n ~ sigma^(2 / (1 + 10/6)).
constexpr int kLightsTogether = 4;     // samples of the lights at a place where only they are uncertain
constexpr double kStratified = 0.75, kTypical = 12;
constexpr double kOwn = 4;             // pixel errors by which one sample of a dot may change it

class AdaptiveFrame {
 public:
  AdaptiveFrame(const RenderScene& scene, const CameraView& view, const FrameOptions& options, LayerImage& image)
      : scene_(scene), view_(view), options_(options), image_(image), controlled_(options.diffuse_light && scene.lights.has_large()),
        first_half_((options.samples + 1) / 2), scene_size_(scene.frame().bounds.diagonal()), pixels_(image.pixels.size()) {}

  void first_samples(RayCounts& rays) {
    for_each_tile(view_, options_, rays, {}, [&](RayCounts& counts) {
      return [&, sparse = SparseCaustics()](std::size_t pixel, int x, int y) mutable { first_samples(pixel, x, y, sparse, counts); };
    });
  }

  /// Returns how many.
  double further_samples(RayCounts& rays) {
    const std::vector<int> missing = missing_samples();
    for_each_tile(view_, options_, rays, options_.progress, [&](RayCounts& counts) {
      return [&, sparse = SparseCaustics()](std::size_t pixel, int x, int y) mutable {
        const int count = missing[pixel], own = pixels_[pixel].own, wanted = options_.samples + count;
        if (count > 0) join_further(pixel, x, y, options_.samples, count, sparse, counts);
        if (!controlled_) return;
        const float seen = seen_around(x, y);
        if (own == 0) return take_noise_out(pixel, seen, wanted);
        const Rgb unchanged = without_noise(image_.pixels[pixel][Layer::direct], pixels_[pixel].direct_noise, seen, wanted);
        join_further(pixel, x, y, wanted, own, sparse, counts);
        take_noise_out(pixel, seen, wanted + own);
        pixels_[pixel].change = unchanged - image_.pixels[pixel][Layer::direct];
      };
    });
    double sum = 0;
    for (std::size_t pixel = 0; pixel < missing.size(); ++pixel) sum += missing[pixel] + pixels_[pixel].own;
    if (controlled_) share_changes();
    return sum;
  }

 private:
  void first_samples(std::size_t pixel, int x, int y, SparseCaustics& sparse, RayCounts& counts) {
    PixelState& state = pixels_[pixel];
    const int n = options_.samples, a = first_half_, b = n - a;
    LightControl control[2];
    PixelSum first, second;
    with_light(pixel, sparse, [&](const DiffuseLight* light) {
      for_each_sample(scene_, view_, options_.seed, light, pixel, x, y, 0, n, 1, counts,
                      [&](int s) { return controlled_ ? &control[s < a ? 0 : 1] : nullptr; },
                      [&](int s, const Layers& sample) { (s < a ? first : second).add(sample); });
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

  /// body(pixel) for the neighbours of a pixel, at most `near` away, that are rendered.
  template <class Body>
  void for_each_neighbour(int x, int y, int near, const Body& body) const {
    for (int j = std::max(0, y - near); j <= std::min(view_.height() - 1, y + near); ++j)
      for (int i = std::max(0, x - near); i <= std::min(view_.width() - 1, x + near); ++i) {
        const std::size_t at = std::size_t(j) * std::size_t(view_.width()) + std::size_t(i);
        if ((i != x || j != y) && (options_.mask.empty() || options_.mask[at])) body(at);
      }
  }

  /// Share of the large lights' light that shadows leave.
  float seen_around(int x, int y) const {
    float sampled = 0, seen = 0;
    for_each_neighbour(x, y, kNear, [&](std::size_t at) {
      sampled += pixels_[at].sampled;
      seen += pixels_[at].seen;
    });
    return sampled > 0 ? seen / sampled : 0;
  }

  /// `count` samples more, from the one of number `first` on.
  void join_further(std::size_t pixel, int x, int y, int first, int count, SparseCaustics& sparse, RayCounts& counts) {
    const int lights = pixels_[pixel].lights;
    LightControl control;
    with_light(pixel, sparse, [&](const DiffuseLight* light) {
      PixelSum sum = sample_pixel(scene_, view_, options_.seed, light, pixel, x, y, first, count / lights, lights, counts,
                                  controlled_ ? &control : nullptr);
      sum.stand_for(lights);
      join(sum, first, count, image_.pixels[pixel]);
    });
    pixels_[pixel].add_noise(control);
  }

  static Rgb without_noise(const Rgb& radiance, const Rgb& noise, float seen, int count) {
    Rgb rest;
    for (int c = 0; c < 3; ++c) rest[c] = std::max(0.0f, radiance[c] - noise[c] * seen / float(count));
    return rest;
  }

  void take_noise_out(std::size_t pixel, float seen, int count) {
    Layers& layers = image_.pixels[pixel];
    layers[Layer::direct] = without_noise(layers[Layer::direct], pixels_[pixel].direct_noise, seen, count);
    layers[Layer::specular] = without_noise(layers[Layer::specular], pixels_[pixel].specular_noise, seen, count);
  }

  /// Of the light that large lights send to a plain pixel: did its first samples see some and miss some, where
  /// its neighbours call for few more? Then it would stand out as a dot. Its own further samples would take light from the
  /// edges of shadows, or give them some: that is shared out again among its neighbours on the same surface.
  void ask_for_own(std::size_t pixel, int x, int y, int samples) {
    PixelState& state = pixels_[pixel];
    const int wanted = int(std::min(double(options_.adaptive_limit), 1 / (kOwn * options_.pixel_error)));
    if (state.lights == 1 || samples >= wanted || !(state.seen > 0 && state.seen < state.sampled)) return;
    for_each_heir(pixel, x, y, [&](std::size_t) { ++state.heirs; });
    if (state.heirs > 0) state.own = (wanted - samples + state.lights - 1) / state.lights * state.lights;
  }

  template <class Body>
  void for_each_heir(std::size_t pixel, int x, int y, const Body& body) const {
    for_each_neighbour(x, y, kNear, [&](std::size_t at) {
      if (pixels_[at].plain && pixels_[at].memory[0].surface == pixels_[pixel].memory[0].surface) body(at);
    });
  }

  /// Few pixels have some: one after the other.
  void share_changes() {
    const auto width = std::size_t(view_.width());
    for (std::size_t pixel = 0; pixel < pixels_.size(); ++pixel) {
      const PixelState& state = pixels_[pixel];
      if (state.own == 0) continue;
      for_each_heir(pixel, int(pixel % width), int(pixel / width), [&](std::size_t at) {
        Rgb& direct = image_.pixels[at][Layer::direct];
        for (int c = 0; c < 3; ++c) direct[c] = std::max(0.0f, direct[c] + state.change[c] / state.heirs);
      });
    }
  }

  /// Variance of a sample, of all but what has edges, as far as stratification leaves it: by the difference of a pixel's
  /// halves. What has edges may agree in a few samples and be wrong: PixelState::sharp_variance counts in full.
  double smooth_variance(std::size_t pixel, int x, int y) const {
    const PixelState& state = pixels_[pixel];
    const double a = first_half_, b = options_.samples - first_half_;
    double difference = double(state.difference);
    if (controlled_) difference -= double(seen_around(x, y) * state.noise_difference);
    return difference * difference * a * b / (a + b);
  }

  /// Of what has edges: that of the neighbours' samples, and a share of the variance between neighbours beyond what their
  /// samples leave. Where these are all of one piece and differ, an edge may run through this pixel alone: the rim of a
  /// lamp that just reaches into a row of dark pixels, of which first samples meet nothing, or many times what there is.
  double sharp_variance(int x, int y) const {
    double within = 0, sum = 0, square = 0;
    int n = 0;
    for_each_neighbour(x, y, kNearSharp, [&](std::size_t at) {
      const PixelState& state = pixels_[at];
      ++n;
      within += state.sharp_variance;
      sum += state.sharp;
      square += state.sharp * state.sharp;
    });
    if (n == 0) return 0;
    within /= n;
    if (n == 1) return within;
    const double between = (square - sum * sum / n) / (n - 1) - within / options_.samples;
    return within + kBetween * std::max(0.0, between);
  }

  /// Do the pixel and the eight around it see one matte surface each? Then it is its light that is uncertain, not which place of
  /// it is seen.
  bool is_plain(int x, int y) const {
    for (int j = std::max(0, y - 1); j <= std::min(view_.height() - 1, y + 1); ++j)
      for (int i = std::max(0, x - 1); i <= std::min(view_.width() - 1, x + 1); ++i)
        if (!pixels_[std::size_t(j) * std::size_t(view_.width()) + std::size_t(i)].plain) return false;
    return true;
  }

  /// Samples each pixel still needs, by what its neighbours saw. Its own samples are left out: a pixel whose
  /// first samples happened to agree would keep them, and penumbrae would come out too bright.
  std::vector<int> missing_samples() {
    double all = 0;
    for (const PixelState& state : pixels_) all += double(state.mean);
    const double picture = all / double(std::max<std::size_t>(1, pixels_.size()));
    std::vector<double> smooth(pixels_.size());
    RayCounts none;
    for_each_pixel(view_, options_, none, {},
                   [&](std::size_t pixel, int x, int y, RayCounts&) { smooth[pixel] = smooth_variance(pixel, x, y); });
    std::vector<int> missing(pixels_.size());
    for_each_pixel(view_, options_, none, {}, [&](std::size_t pixel, int x, int y, RayCounts&) {
      double pooled = 0, level = 0;
      int n = 0;
      for_each_neighbour(x, y, kNear, [&](std::size_t at) {
        ++n;
        pooled += smooth[at];
        level += double(pixels_[at].mean);
      });
      if (n == 0) return;   // a picture of one pixel
      const double sigma = std::sqrt(pooled / n + sharp_variance(x, y));
      const double error = options_.pixel_error * (std::min(level / n, picture) + 0.1 * picture);
      const double wanted = error > 0 ? kTypical * std::pow(sigma / (kTypical * error), kStratified) : 0;
      const int more = std::clamp(int(std::min(wanted, double(options_.adaptive_limit))) - options_.samples, 0, options_.adaptive_limit);
      const int lights = pixels_[pixel].lights = is_plain(x, y) ? kLightsTogether : 1;
      missing[pixel] = more > 0 ? std::max(1, (more + lights / 2) / lights) * lights : 0;
      if (controlled_) ask_for_own(pixel, x, y, options_.samples + missing[pixel]);
    });
    return missing;
  }

  const RenderScene& scene_;
  const CameraView& view_;
  const FrameOptions& options_;
  LayerImage& image_;
  bool controlled_;
  int first_half_;
  float scene_size_;
  std::vector<PixelState> pixels_;
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
