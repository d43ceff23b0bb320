#include "lib/render/frame_renderer.h"

#include <algorithm>
#include <mutex>

#include "formats/error.h"
#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr int kTile = 16;

/// Sums over one pixel's samples.
struct PixelSum {
  LayersT<double> layers;
  double square = 0;      ///< of the samples' mean channel
  void add(const Layers& sample) {
    double value = 0;
    for (std::size_t l = 0; l < kLayerCount; ++l) {
      const Rgbd radiance(sample.value[l]);
      layers.value[l] += radiance;
      value += (radiance.r + radiance.g + radiance.b) / 3;
    }
    layers.coverage += double(sample.coverage);
    square += value * value;
  }
  double value() const {
    double sum = 0;
    for (const Rgbd& radiance : layers.value) sum += (radiance.r + radiance.g + radiance.b) / 3;
    return sum;
  }
};

/// Joins the sum over samples first .. first+count-1 to the mean over the first `first`.
void join(const PixelSum& sum, int first, int count, Layers& mean) {
  const double old_weight = double(first) / (first + count), new_weight = 1.0 / (first + count);
  for (std::size_t l = 0; l < kLayerCount; ++l)
    mean.value[l] = Rgb(Rgbd(mean.value[l]) * old_weight + sum.layers.value[l] * new_weight);
  mean.coverage = float(double(mean.coverage) * old_weight + sum.layers.coverage * new_weight);
}

/// Runs body(pixel, x, y, counts) for every pixel, tile by tile in parallel.
template <class Body>
void for_each_pixel(const CameraView& view, const FrameOptions& options, RayCounts& rays, const std::function<void(double)>& progress, const Body& body) {
  const int tiles_x = (view.width() + kTile - 1) / kTile, tiles = tiles_x * ((view.height() + kTile - 1) / kTile);
  std::mutex mutex;
  int done = 0;
  parallel_chunks(std::size_t(tiles), 1, [&](std::size_t tile, std::size_t) {
    RayCounts counts;
    const int x0 = int(tile) % tiles_x * kTile, y0 = int(tile) / tiles_x * kTile;
    for (int y = y0; y < std::min(y0 + kTile, view.height()); ++y)
      for (int x = x0; x < std::min(x0 + kTile, view.width()); ++x) {
        const std::size_t pixel = std::size_t(y) * std::size_t(view.width()) + std::size_t(x);
        if (options.mask.empty() || options.mask[pixel]) body(pixel, x, y, counts);
      }
    const std::lock_guard lock(mutex);
    rays += counts;
    if (progress) progress(double(++done) / tiles);
  });
}

/// A pixel's first samples ask for caustic and indirect light; if they all met one surface, later samples that meet
/// it take the mean of those answers: that light is smooth, and they are there for the direct light. What is seen in a
/// mirror or gloss may be far away on the same surface: it is always asked for.
class PixelLight : public DiffuseLight {
 public:
  struct Memory {
    std::uint32_t surface = kNone;   ///< kNone: nothing met yet
    int count = 0;                   ///< 0 after several surfaces were met: nothing to reuse
    Irradiance sum;
  };
  PixelLight(const DiffuseLight& light, Memory& memory, bool reuse) : light_(light), memory_(memory), reuse_(reuse) {}

  Irradiance at(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, bool direct_view) const override {
    if (!direct_view) return light_.at(surface, geometric, shading, false);
    if (reuse_) {
      if (memory_.count == 0 || surface.surface != memory_.surface) return light_.at(surface, geometric, shading, true);
      const float scale = 1 / float(memory_.count);
      return {memory_.sum.caustic * scale, memory_.sum.indirect * scale};
    }
    const Irradiance found = light_.at(surface, geometric, shading, true);
    const bool same = memory_.surface == kNone || (memory_.count > 0 && memory_.surface == surface.surface);
    memory_.surface = surface.surface;
    memory_.count = same ? memory_.count + 1 : 0;
    memory_.sum.caustic += found.caustic;
    memory_.sum.indirect += found.indirect;
    return found;
  }

 private:
  const DiffuseLight& light_;
  Memory& memory_;
  bool reuse_;
};

PixelSum sample_pixel(const RenderScene& scene, const CameraView& view, std::uint64_t seed, const DiffuseLight* light,
                      std::size_t pixel, int x, int y, int first, int count, RayCounts& counts) {
  PixelSum sum;
  for (int s = first; s < first + count; ++s) {
    const PixelRandom random(seed, pixel, std::uint32_t(s));
    const Vec2 jitter = random.get2(0, Purpose::pixel);
    sum.add(trace_eye_path(scene, view.ray(float(x) + jitter.x, float(y) + jitter.y), random, light, counts, view.cone()));
  }
  return sum;
}

/// Samples [first, first + count) of every pixel of one half, joined to what `image` holds already.
void render_pass(const RenderScene& scene, const CameraView& view, std::uint64_t seed, const FrameOptions& options,
                 int count, LayerImage& image, RayCounts& rays, const std::function<void(double)>& progress) {
  const int first = image.samples;
  for_each_pixel(view, options, rays, progress, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    join(sample_pixel(scene, view, seed, options.diffuse_light, pixel, x, y, first, count, counts), first, count,
         image.pixels[pixel]);
  });
  image.samples += count;
}

/// Samples each pixel still needs, by what its eight neighbours saw. Its own samples are left out: a pixel whose
/// first samples happened to agree would keep them, and penumbrae would come out too bright.
std::vector<int> missing_samples(const CameraView& view, const FrameOptions& options, const std::vector<double>& mean,
                                 const std::vector<double>& variance) {
  const int width = view.width(), height = view.height();
  double all = 0;
  for (double m : mean) all += m;
  const double picture = all / double(std::max<std::size_t>(1, mean.size()));
  std::vector<int> missing(mean.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double pooled = 0, level = 0;
      int n = 0;
      for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i) {
          const std::size_t at = std::size_t(j) * std::size_t(width) + std::size_t(i);
          if ((i == x && j == y) || (!options.mask.empty() && !options.mask[at])) continue;
          ++n;
          pooled += variance[at];
          level += mean[at];
        }
      if (n == 0) continue;   // a picture of one pixel
      const double error = options.pixel_error * (std::min(level / n, picture) + 0.1 * picture);
      const double wanted = error > 0 ? std::sqrt(pooled / n) / error : 0;
      missing[std::size_t(y) * std::size_t(width) + std::size_t(x)] =
          std::clamp(int(std::min(wanted, double(options.adaptive_limit))) - options.samples, 0, options.adaptive_limit);
    }
  return missing;
}

/// `samples` everywhere, then more where they are needed.
void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options, RenderedFrame& frame) {
  LayerImage& image = frame.mean;
  std::vector<double> mean(image.pixels.size()), variance(image.pixels.size());
  std::vector<PixelLight::Memory> memory(options.diffuse_light ? image.pixels.size() : 0);
  const auto sample = [&](std::size_t pixel, int x, int y, int first, int count, RayCounts& counts) {
    if (!options.diffuse_light) return sample_pixel(scene, view, options.seed, nullptr, pixel, x, y, first, count, counts);
    const PixelLight light(*options.diffuse_light, memory[pixel], first > 0);
    return sample_pixel(scene, view, options.seed, &light, pixel, x, y, first, count, counts);
  };
  for_each_pixel(view, options, frame.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    const PixelSum sum = sample(pixel, x, y, 0, options.samples, counts);
    join(sum, 0, options.samples, image.pixels[pixel]);
    mean[pixel] = sum.value() / options.samples;
    variance[pixel] = std::max(0.0, sum.square - mean[pixel] * sum.value()) / std::max(1, options.samples - 1);
  });
  const std::vector<int> missing = missing_samples(view, options, mean, variance);
  for_each_pixel(view, options, frame.rays, options.progress, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    if (const int count = missing[pixel])
      join(sample(pixel, x, y, options.samples, count, counts), options.samples, count, image.pixels[pixel]);
  });
  double sum = 0;
  for (int count : missing) sum += count;
  image.samples = options.samples;
  frame.samples_per_pixel = options.samples + sum / double(std::max<std::size_t>(1, missing.size()));
}

LayerImage empty_layers(const CameraView& view) {
  LayerImage image{view.width(), view.height(), 0, {}};
  image.pixels.resize(std::size_t(view.width()) * std::size_t(view.height()));
  return image;
}

Rgb total(const Layers& layers) {
  Rgb sum = layers.value[0];
  for (std::size_t l = 1; l < kLayerCount; ++l) sum += layers.value[l];
  return sum;
}

double mean_radiance(const LayerImage& image) {
  double sum = 0;
  for (const Layers& pixel : image.pixels) {
    const Rgb t = total(pixel);
    sum += double(t.r) + double(t.g) + double(t.b);
  }
  return sum / double(std::max<std::size_t>(1, 3 * image.pixels.size()));
}

/// Mean of the two halves, its error from their difference: E[(a-b)^2] / 4 is the variance of (a+b)/2.
void join_halves(RenderedFrame& frame) {
  const LayerImage &a = frame.half[0], &b = frame.half[1];
  frame.mean = a;
  frame.mean.samples = a.samples + b.samples;
  double difference2 = 0;
  for (std::size_t p = 0; p < a.pixels.size(); ++p) {
    Layers& mean = frame.mean.pixels[p];
    for (std::size_t l = 0; l < kLayerCount; ++l) mean.value[l] = (a.pixels[p].value[l] + b.pixels[p].value[l]) * 0.5f;
    mean.coverage = (a.pixels[p].coverage + b.pixels[p].coverage) * 0.5f;
    const Rgbd d = Rgbd(total(a.pixels[p])) - Rgbd(total(b.pixels[p]));
    difference2 += d.r * d.r + d.g * d.g + d.b * d.b;
  }
  frame.own_rmse = std::sqrt(difference2 / 4 / double(std::max<std::size_t>(1, 3 * a.pixels.size())));
}

}  // namespace

RenderedFrame render_frame(const RenderScene& scene, const CameraView& view, const FrameOptions& options) {
  RenderedFrame frame;
  const bool halves = options.halves || options.target_error > 0;
  if (!halves && options.pixel_error > 0) {
    frame.mean = empty_layers(view);
    render_adaptive(scene, view, options, frame);
  } else if (!halves) {
    frame.mean = empty_layers(view);
    render_pass(scene, view, options.seed, options, options.samples, frame.mean, frame.rays, options.progress);
  } else {
    // The second half's seed is far from any user's seeds.
    const std::uint64_t seeds[2] = {options.seed, options.seed ^ 0x68616c665f74776full};
    frame.half[0] = empty_layers(view);
    frame.half[1] = empty_layers(view);
    int count = std::max(1, options.samples / 2);
    for (;;) {
      for (int h = 0; h < 2; ++h)
        render_pass(scene, view, seeds[h], options, count, frame.half[h], frame.rays,
                    options.progress ? [&, h](double f) { options.progress((f + h) / 2); } : options.progress);
      join_halves(frame);
      if (!(options.target_error > 0) || frame.own_rmse <= options.target_error * mean_radiance(frame.mean)) break;
      count = frame.half[0].samples;
      if (4 * count > options.max_samples) break;
    }
  }
  frame.mean_radiance = mean_radiance(frame.mean);
  if (!(frame.samples_per_pixel > 0)) frame.samples_per_pixel = frame.mean.samples;
  return frame;
}

void keep_base_pixels(const std::vector<std::uint8_t>& mask, const Image& base, Image& image) {
  if (base.width != image.width || base.height != image.height)
    throw InputError("--base: " + std::to_string(base.width) + "x" + std::to_string(base.height) + " pixels, but --size is " +
                     std::to_string(image.width) + "x" + std::to_string(image.height) + "; render both at one size");
  for (Channel& channel : image.channels) {
    const Channel* from = base.find(channel.name);
    if (!from || from->values.size() != channel.values.size())
      throw InputError("--base: has no channel " + channel.name + "; ask for fewer with --channels, or render the base with it");
    for (std::size_t p = 0; p < mask.size(); ++p) {
      if (mask[p]) continue;
      if (channel.ids.empty()) channel.values[p] = from->values[p];
      else channel.ids[p] = from->ids[p];
    }
  }
}

void add_colour_channels(const LayerImage& layers, const std::vector<std::string>& channels, Image& image) {
  const auto add = [&](const std::string& prefix, auto&& value_of) {
    constexpr const char* kNames[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
      Channel& channel = image.add(prefix + kNames[c]);
      for (std::size_t p = 0; p < layers.pixels.size(); ++p) channel.values[p] = value_of(layers.pixels[p])[c];
    }
  };
  for (const std::string& name : channels) {
    if (name == "RGBA") {
      add("", [](const Layers& pixel) { return total(pixel); });
      Channel& alpha = image.add("A");
      for (std::size_t p = 0; p < layers.pixels.size(); ++p) alpha.values[p] = layers.pixels[p].coverage;
    }
    for (std::size_t l = 0; l < kLayerCount; ++l)
      if (name == "layers" || name == kLayerNames[l])
        add(std::string(kLayerNames[l]) + ".", [l](const Layers& pixel) { return pixel.value[l]; });
  }
}

}  // namespace tempolux
