#include "lib/render/adaptive_frame.h"

#include <algorithm>
#include <cmath>
#include <mutex>

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
  std::uint32_t surface = kNone;        ///< met by the first
  double sharp = 0, sharp_variance = 0; ///< of one of the first: PixelSum::sharp; a square of light may be beyond float
  float difference = 0, noise_difference = 0;     ///< of all else: mean over half of the first samples less that over the others

  void add_noise(const LightControl& more) {
    direct_noise += more.direct;
    specular_noise += more.specular;
  }
};

// Pixels: one is judged by the 24 around it; by 8 for what has edges, which are narrow: all that see one pay for it.
constexpr int kNear = 2, kNearSharp = 1;
constexpr double kBetween = 0.1, kSharp = 0.5;   // of its variance: more samples there make less of the picture's error
constexpr double kBright = 4;          // times the picture's mean: what is brighter is seen as white, and its error so
// Samples that are stratified err as n^(-5/6) or so. The least error for a number of samples has n ~ sigma^(2 / (1 + 10/6)).
constexpr int kLightsTogether = 4;     // samples of the lights at a place where only they are uncertain
constexpr double kStratified = 0.75, kTypical = 12;
constexpr double kOwn = 4;             // pixel errors by which one sample of a dot may change it
constexpr double kSpot = 2;            // times the samples it got that a pixel would ask for by all of them, and stands out

/// What further samples for its own sake took from a pixel [W/m^2/sr], to be shared out among its neighbours.
struct Change {
  std::size_t pixel = 0;
  Layers taken;
};

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
        PixelState& state = pixels_[pixel];
        const int count = missing[pixel], taken = options_.samples + count;
        PixelSum sum;
        if (count > 0) sum = join_further(pixel, x, y, options_.samples, count, sparse, counts);
        if (state.own == 0 && state.lights == 1 && options_.diffuse_light) state.own = spot_samples(pixel, x, y, sum, taken);
        const float seen = controlled_ ? seen_around(x, y) : 0;
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
    const int n = options_.samples, a = first_half_, b = n - a;
    LightControl control[2];
    PixelSum first, second;
    with_light(pixel, sparse, [&](const DiffuseLight* light) {
      for_each_sample(scene_, view_, options_.seed, light, pixel, x, y, 0, n, 1, counts,
                      [&](int s) { return controlled_ ? &control[s < a ? 0 : 1] : nullptr; },
                      [&](int s, std::uint32_t surface, const Layers& sample) {
                        (s < a ? first : second).add(sample);
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
  PixelSum join_further(std::size_t pixel, int x, int y, int first, int count, SparseCaustics& sparse, RayCounts& counts) {
    const int lights = pixels_[pixel].lights;
    LightControl control;
    PixelSum sum;
    with_light(pixel, sparse, [&](const DiffuseLight* light) {
      sum = sample_pixel(scene_, view_, options_.seed, light, pixel, x, y, first, count / lights, lights, counts,
                                  controlled_ ? &control : nullptr);
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

  /// Of the light that large lights send to a plain pixel: did its first samples see some and miss some, where
  /// its neighbours call for few more? Then it would stand out as a dot. Its own further samples would take light from the
  /// edges of shadows, or give them some: that is shared out again among its neighbours on the same surface.
  void ask_for_own(std::size_t pixel, int x, int y, int samples) {
    PixelState& state = pixels_[pixel];
    const int wanted = int(std::min(double(options_.adaptive_limit), 1 / (kOwn * options_.pixel_error)));
    if (state.lights == 1 || samples >= wanted || !(state.seen > 0 && state.seen < state.sampled)) return;
    if (count_heirs(pixel, x, y) > 0) state.own = (wanted - samples + state.lights - 1) / state.lights * state.lights;
  }

  /// Samples for its own sake of a pixel that stands out by what has edges: one of its samples met a lamp that is smaller than
  /// a pixel in a curved mirror, say, and its neighbours' first samples had met none. Shared out like a dot's.
  int spot_samples(std::size_t pixel, int x, int y, const PixelSum& further, int samples) const {
    const PixelState& state = pixels_[pixel];
    const double first = options_.samples, sum = state.sharp * first + further.sharp,
                 square = state.sharp_variance * (first - 1) + state.sharp * state.sharp * first + further.sharp_square;
    const double variance = std::max(0.0, square - sum * sum / samples) / std::max(1, samples - 1);
    const double wanted = std::min(wanted_samples(std::sqrt(variance), level_around(x, y)), double(options_.adaptive_limit));
    return wanted > kSpot * samples && count_heirs(pixel, x, y) > 0 ? int(wanted) - samples : 0;
  }

  template <class Body>
  void for_each_heir(std::size_t pixel, int x, int y, const Body& body) const {
    for_each_neighbour(x, y, kNear, [&](std::size_t at) {
      if (pixels_[at].plain == pixels_[pixel].plain && pixels_[at].surface == pixels_[pixel].surface) body(at);
    });
  }

  int count_heirs(std::size_t pixel, int x, int y) const {
    int count = 0;
    for_each_heir(pixel, x, y, [&](std::size_t) { ++count; });
    return count;
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
      const auto heirs = float(count_heirs(pixel, x, y));
      for_each_heir(pixel, x, y, [&, taken = &taken](std::size_t at) {
        for (std::size_t l = 0; l < kLayerCount; ++l) {
          Rgb& radiance = image_.pixels[at].value[l];
          for (int c = 0; c < 3; ++c) radiance[c] = std::max(0.0f, radiance[c] + taken->value[l][c] / heirs);
        }
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
    picture_ = all / double(std::max<std::size_t>(1, pixels_.size()));
    std::vector<double> smooth(pixels_.size());
    RayCounts none;
    for_each_pixel(view_, options_, none, {},
                   [&](std::size_t pixel, int x, int y, RayCounts&) { smooth[pixel] = smooth_variance(pixel, x, y); });
    std::vector<int> missing(pixels_.size());
    for_each_pixel(view_, options_, none, {}, [&](std::size_t pixel, int x, int y, RayCounts&) {
      double pooled = 0;
      int n = 0;
      for_each_neighbour(x, y, kNear, [&](std::size_t at) {
        ++n;
        pooled += smooth[at];
      });
      if (n == 0) return;   // a picture of one pixel
      const double sigma = std::sqrt(pooled / n + kSharp * sharp_variance(x, y));
      const double wanted = wanted_samples(sigma, level_around(x, y));
      const int more = std::clamp(int(std::min(wanted, double(options_.adaptive_limit))) - options_.samples, 0, options_.adaptive_limit);
      const int lights = pixels_[pixel].lights = is_plain(x, y) ? kLightsTogether : 1;
      missing[pixel] = more > 0 ? std::max(1, (more + lights / 2) / lights) * lights : 0;
      if (controlled_) ask_for_own(pixel, x, y, options_.samples + missing[pixel]);
    });
    return missing;
  }

  double level_around(int x, int y) const {
    double level = 0;
    int n = 0;
    for_each_neighbour(x, y, kNear, [&](std::size_t at) {
      ++n;
      level += double(pixels_[at].mean);
    });
    return n > 0 ? level / n : 0;
  }

  double wanted_samples(double sigma, double level) const {
    const double error = options_.pixel_error * (std::min(level, kBright * picture_) + 0.1 * picture_);
    return error > 0 ? kTypical * std::pow(sigma / (kTypical * error), kStratified) : 0;
  }

  const RenderScene& scene_;
  const CameraView& view_;
  const FrameOptions& options_;
  LayerImage& image_;
  bool controlled_;
  int first_half_;
  float scene_size_;
  double picture_ = 0;   ///< mean of all pixels' first samples
  std::vector<PixelState> pixels_;
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
