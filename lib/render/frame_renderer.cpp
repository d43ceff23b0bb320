#include "lib/render/frame_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/error.h"
#include "formats/large_pages.h"
#include "lib/core/parallel_each.h"
#include "lib/image/channel_groups.h"
#include "lib/render/adaptive_frame.h"
#include "lib/render/known_light.h"
#include "lib/render/pixel_samples.h"

namespace tempolux {
namespace {

/// Takes `count` samples of every pixel of the mask; `image` has none.
void take_samples(const CameraSampler& camera, std::span<const std::uint8_t> mask, int count, LayerImage& image,
                  RayCounts& rays, const std::function<void(double)>& progress) {
  for_each_pixel(camera.view, mask, rays, progress, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    const PixelSum sum = sample_pixel(camera, {pixel, x, y, {}, {count, count, count}}, image.halves_of(pixel), counts);
    join(sum, 0, count, image.pixels[pixel]);
    if (!image.stored_noise.empty()) join(sum.stored_noise, 0, count, image.stored_noise[pixel]);
  });
  image.samples = count;
}

/// Takes all samples at once, and renders some pixels a second time to measure noise.
void render_fixed(const RenderScene& scene, const CameraView& view, const FrameOptions& options, RenderedFrame& frame) {
  take_samples({scene, view, options.known, options.seed, options.shutter}, options.mask, options.samples, frame.mean,
               frame.rays, options.progress);
  NoiseCheck check(view, options.seed, options.mask);
  const CameraSampler again{scene, view, options.known, check.seed(), options.shutter};
  const PartCounts all{options.samples, options.samples, options.samples};
  for_each_pixel(view, options.mask, frame.noise_rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    if (const std::uint32_t slot = check.slot(x, y); slot != kNone)
      join(sample_pixel(again, {pixel, x, y, {}, all}, &check.again_halves(slot), counts), 0, options.samples,
           check.again(slot).own);
  });
  const auto as_sampled = [&](std::size_t pixel) { return frame.mean.pixels[pixel]; };
  frame.noise = check.measure(frame.mean.pixels, as_sampled, frame.mean.stored_noise);
  if (options.sample_halves) frame.mean.difference_share = check.shares(frame.mean.sample_halves, as_sampled);
}

LayerImage empty_layers(const RenderScene& scene, const CameraView& view, const FrameOptions& options) {
  LayerImage image;
  image.media = scene.frame().media != nullptr;
  image.width = view.width();
  image.height = view.height();
  const std::size_t count = std::size_t(view.width()) * std::size_t(view.height());
  image.pixels.reserve(count);
  formats::prefer_large_pages(image.pixels.data(), count * sizeof(Layers));
  image.pixels.resize(count);
  if (options.sample_halves) image.sample_halves.resize(count);
  if (options.known && options.known->has_noise()) image.stored_noise.resize(count);
  return image;
}

/// Sets frame.mean to the mean of the two halves, and frame.noise from their difference.
void join_halves(RenderedFrame& frame) {
  const LayerImage &a = frame.half[0], &b = frame.half[1];
  frame.mean = a;
  frame.mean.samples = a.samples + b.samples;
  for (std::size_t p = 0; p < frame.mean.sample_halves.size(); ++p) frame.mean.sample_halves[p] += b.sample_halves[p];
  for (std::size_t p = 0; p < a.pixels.size(); ++p) {
    Layers& mean = frame.mean.pixels[p];
    for (std::size_t l = 0; l < kLayerCount; ++l) mean.value[l] = (a.pixels[p].value[l] + b.pixels[p].value[l]) * 0.5f;
    mean.coverage = (a.pixels[p].coverage + b.pixels[p].coverage) * 0.5f;
  }
  frame.noise = noise_of_halves(frame.mean.pixels, a.pixels, b.pixels);
}

/// Bits by which the seeds of a reference's halves differ from the frame's seed. If a half used the random numbers of a
/// frame, a frame with the same seed and number of samples would look better than it is.
constexpr std::array<std::uint64_t, 2> kSeedsOfHalves{0x68616c665f6f6e65ull, 0x68616c665f74776full};

}  // namespace

std::vector<std::uint64_t> seeds_of_samples(const FrameOptions& options) {
  if (!options.halves) return {options.seed};
  return {options.seed ^ kSeedsOfHalves[0], options.seed ^ kSeedsOfHalves[1]};
}

RenderedFrame render_frame(const RenderScene& scene, const CameraView& view, const FrameOptions& options) {
  RenderedFrame frame;
  if (options.halves) {
    const std::vector<std::uint64_t> seeds = seeds_of_samples(options);
    for (std::size_t h = 0; h < 2; ++h) {
      frame.half[h] = empty_layers(scene, view, options);
      take_samples({scene, view, options.known, seeds[h], options.shutter}, options.mask,
                   std::max(1, options.samples / 2), frame.half[h], frame.rays,
                   options.progress ? [&, h](double f) { options.progress((f + double(h)) / 2); } : options.progress);
    }
    join_halves(frame);
  } else {
    frame.mean = empty_layers(scene, view, options);
    if (options.pixel_error > 0) render_adaptive(scene, view, options, frame);
    else render_fixed(scene, view, options, frame);
  }
  const std::vector<Layers>& pixels = frame.mean.pixels;
  frame.mean_radiance =
      parallel_sum<double>(pixels.size(), 4096, [&](std::size_t p, double& sum) { sum += radiance_of(pixels[p]); }) /
      double(pixels.size());
  if (!(frame.samples_per_pixel > 0)) frame.samples_per_pixel = frame.mean.samples;
  return frame;
}

void keep_base_pixels(const std::vector<std::uint8_t>& mask, const Image& base, std::size_t data_channels,
                      Image& image) {
  if (base.width != image.width || base.height != image.height)
    throw InputError("--base: " + std::to_string(base.width) + "x" + std::to_string(base.height) +
                     " pixels, but --size is " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                     "; render both at one size");
  for (std::size_t i = 0; i < image.channels.size(); ++i) {
    Channel& channel = image.channels[i];
    if (is_matte(channel.name)) continue;
    const Channel* from = base.find(channel.name);
    if (!from && i < data_channels) continue;
    const bool known =
        !from && (channel.name.find(".noise.") != std::string::npos || channel.name == "halves.confirmed");
    if (!known && (!from || from->values.size() != channel.values.size()))
      throw InputError("--base: has no channel " + channel.name +
                       "; ask for fewer with --channels, or render the base with it");
    for (std::size_t p = 0; p < mask.size(); ++p) {
      if (mask[p]) continue;
      if (channel.ids.empty()) channel.values[p] = known ? 0 : from->values[p];
      else channel.ids[p] = from->ids[p];
    }
  }
}

void add_colour_channels(const LayerImage& layers, const std::vector<std::string>& channels, Image& image) {
  if (!layers.sample_halves.empty()) add_variance_channels(layers, channels, image);
  for (const std::string& name : channels) {
    if (name == "RGBA") {
      add_colour("", image, [&](std::size_t p) { return sum_of_layers<float>(layers.pixels[p]); });
      std::vector<float>& alpha = image.add("A").values;
      for (std::size_t p = 0; p < alpha.size(); ++p) alpha[p] = layers.pixels[p].coverage;
    }
    for (std::size_t l = 0; l < kLayerCount; ++l)
      if ((name == "layers" && (layers.media || l != std::size_t(Layer::volume))) || name == kLayerNames[l])
        add_colour(std::string(kLayerNames[l]) + ".", image, [&](std::size_t p) { return layers.pixels[p].value[l]; });
  }
}

}  // namespace tempolux
