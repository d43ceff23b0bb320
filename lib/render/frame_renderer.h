// lib/render/frame_renderer.h -- all pixels of a frame: colour layers averaged over samples.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/frame_noise.h"
#include "lib/render/path_tracer.h"
#include "lib/render/pixel_variance.h"

namespace tempolux {

struct FrameOptions {
  std::uint64_t seed = 0;
  int samples = 16;  ///< per pixel; with halves an even number, half of them in each
  /// Keep two halves for a reference: independent of each other and of any frame rendered without halves, whatever its
  /// seed.
  bool halves = false;
  /// > 0: after `samples` everywhere, take more where pixels are noisy (lib/render/adaptive_frame.h).
  double pixel_error = 0;
  /// > 0: take further samples, distributed as pixel_error asks for, until the noise is below this, in codes
  /// (FrameNoise). Needs pixel_error.
  double seen_error = 0;
  int adaptive_limit = 1024;  ///< largest number of samples of a pixel with pixel_error
  /// With pixel_error: spreads light that a single sample found over the pixels around. In a masked frame only pixels
  /// of the mask receive it (lib/render/spread_outliers.h).
  bool spread_outliers = false;
  bool sample_halves = false;         ///< keep LayerImage::sample_halves
  const KnownLight* known = nullptr;  ///< light at which camera paths may end
  std::vector<std::uint8_t> mask;     ///< by pixel, 0: not rendered; empty: all pixels
  /// By pixel, 1: at an edge between surfaces, 0: inside one. Only for frames that lib/filter will filter: pixels at
  /// edges get more of the samples that pixel_error asks for (PixelNoise::wanted_at). Empty: all pixels are alike.
  std::vector<std::uint8_t> edges;
  std::function<void(double)> progress;  ///< called with [0, 1]; may be empty
};

/// Mean radiance by layer and pixel of one half (or of all samples).
struct LayerImage {
  int width = 0, height = 0, samples = 0;
  bool media = false;                       ///< the scene has media: "layers" holds the layer volume, too
  std::vector<Layers> pixels;               ///< width * height, top row first
  std::vector<StoredNoise> stored_noise;    ///< of the same pixels; empty unless KnownLight::has_noise()
  std::vector<SampleHalves> sample_halves;  ///< of the same pixels; empty unless asked for
  /// Of the same pixels: bit l is set if further samples have confirmed an outlier of layer l; or empty.
  std::vector<std::uint8_t> confirmed;
  /// By layer the variance of a pixel's mean over the mean square of SampleHalves::difference (NoiseCheck::shares).
  std::array<double, kLayerCount> difference_share{1, 1, 1, 1, 1, 1};
  SampleHalves* halves_of(std::size_t pixel) { return sample_halves.empty() ? nullptr : &sample_halves[pixel]; }
};

struct RenderedFrame {
  LayerImage mean;     ///< mean over all samples
  LayerImage half[2];  ///< empty unless halves
  RayCounts rays;
  RayCounts noise_rays;          ///< rays of the second rendering of pixels that are rendered twice
  double samples_per_pixel = 0;  ///< mean over pixels
  FrameNoise noise;              ///< remaining noise
  double at_limit = 0;           ///< share of the pixels that have reached the limit adaptive_limit of samples
  double spread = 0;             ///< share of the light that spread_outliers moved
  double mean_radiance = 0;      ///< over pixels and channels
};

/// Renders a frame with a box filter of one pixel; the samples of a pixel are stratified over its area. Deterministic
/// for any number of threads.
RenderedFrame render_frame(const RenderScene& scene, const CameraView& view, const FrameOptions& options);

/// Copies pixels with mask 0 from `base`, bit for bit, in every channel of `image`. The first `data_channels` channels
/// of `image` are valid for every pixel and stay where `base` lacks them. If `base` lacks a channel LAYER.noise, the
/// noise is set to 0. Throws InputError that names the difference if sizes or channels do not fit.
void keep_base_pixels(const std::vector<std::uint8_t>& mask, const Image& base, std::size_t data_channels,
                      Image& image);

/// Adds the requested colour channels to `image`: "RGBA", "layers" or a layer's name. The sum of the layers in the
/// order of kLayerNames, in float32, is exactly R G B. Also adds the channels of add_variance_channels().
void add_colour_channels(const LayerImage& layers, const std::vector<std::string>& channels, Image& image);

/// Adds data channels of one ray through each pixel's centre: "Z", "N", "P", "id", "albedo", "motion" (forward and
/// backward, in pixels, +u right, +v up; zero where no surface is seen). N is the shading normal, normal map included.
/// albedo is read from the textures at the pixel's level. A surface with alpha mode BLEND is met or passed at random,
/// once per pixel. `next` and `previous` are the scene one frame later and earlier with their cameras; only motion
/// needs them.
struct NeighbourFrame {
  const SceneFrame* frame = nullptr;
  const CameraView* view = nullptr;
};
void add_data_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       const NeighbourFrame& next, const NeighbourFrame& previous, Image& image);

/// Throws InputError that lists the known groups if `channels` holds an unknown group.
void check_channels(const std::vector<std::string>& channels);

}  // namespace tempolux
