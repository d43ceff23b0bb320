// lib/render/frame_renderer.h -- renders all pixels of a frame: colour layers, averaged over samples.
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

class Shutter;

struct FrameOptions {
  std::uint64_t seed = 0;
  int samples = 16;  ///< per pixel; with halves an even number, half of them in each
  /// Render two halves for a reference. They are independent of each other and of frames without halves of any seed.
  bool halves = false;
  /// > 0: first take `samples` in each pixel, then more in pixels whose error is larger than this
  /// (lib/render/adaptive_frame.h; relative, as in allowed_error). 0: take no more.
  double pixel_error = 0;
  /// > 0: take further samples, distributed as pixel_error asks for, until the noise is below this, in codes
  /// (FrameNoise). Needs pixel_error.
  double seen_error = 0;
  int adaptive_limit = 1024;  ///< largest number of samples of a pixel with pixel_error
  /// With pixel_error: spread light that a single sample of a pixel found over the pixels around it
  /// (lib/render/spread_outliers.h). In a masked frame only pixels of the mask receive light.
  bool spread_outliers = false;
  bool sample_halves = false;         ///< keep LayerImage::sample_halves
  bool camera_samples = false;        ///< keep RenderedFrame::camera_samples
  const Shutter* shutter = nullptr;   ///< motion blur; null: all samples see one moment
  const KnownLight* known = nullptr;  ///< light at which camera paths may end; or null
  std::vector<std::uint8_t> mask;     ///< by pixel, 0: not rendered; empty: all pixels are rendered
  /// By pixel, 1: at an edge between surfaces, 0: inside one. Only for frames that lib/filter will filter: pixels at
  /// edges get more of the samples that pixel_error asks for (PixelNoise::wanted_at). Empty: no pixel gets more.
  std::vector<std::uint8_t> edges;
  std::function<void(double)> progress;  ///< called with [0, 1]; may be empty
};

/// Mean radiance of all samples, or of one half of them.
struct LayerImage {
  int width = 0, height = 0;                ///< pixels
  int samples = 0;                          ///< first samples per pixel
  bool media = false;                       ///< the scene has media: the channels "layers" include volume
  std::vector<Layers> pixels;               ///< width * height, top row first
  std::vector<StoredNoise> stored_noise;    ///< of the same pixels; empty unless KnownLight::has_noise()
  std::vector<SampleHalves> sample_halves;  ///< of the same pixels; empty unless asked for
  /// By pixel: bit l is set if further samples have confirmed an outlier of layer l. Empty unless outliers are spread
  /// and sample_halves are kept.
  std::vector<std::uint8_t> confirmed;
  /// By layer: the variance of a pixel's mean over the mean square of SampleHalves::difference (NoiseCheck::shares).
  std::array<double, kLayerCount> difference_share{1, 1, 1, 1, 1, 1};
  /// The halves of a pixel; nullptr if the frame has none.
  SampleHalves* halves_of(std::size_t pixel) { return sample_halves.empty() ? nullptr : &sample_halves[pixel]; }
};

struct RenderedFrame {
  LayerImage mean;     ///< mean over all samples
  LayerImage half[2];  ///< empty unless halves
  RayCounts rays;
  RayCounts noise_rays;          ///< rays of the second rendering (NoiseCheck)
  double samples_per_pixel = 0;  ///< mean number of camera rays
  /// Number of camera samples of each pixel. Empty unless FrameOptions::camera_samples is set. Also empty without a
  /// pixel error, because each pixel then has mean.samples.
  std::vector<std::uint32_t> camera_samples;
  FrameNoise noise;          ///< remaining noise
  double at_limit = 0;       ///< share of the pixels that have reached FrameOptions::adaptive_limit
  double spread = 0;         ///< share of the light that spread_outliers moved
  double mean_radiance = 0;  ///< W/m^2/sr, mean over pixels and channels
};

/// Renders a frame. A pixel is the mean of samples that are stratified over its area (box filter). Same frame for any
/// number of threads.
RenderedFrame render_frame(const RenderScene& scene, const CameraView& view, const FrameOptions& options);

/// Seeds of the camera samples of a frame's pixels: one seed, or a seed for each half. Each half has half of the
/// samples.
std::vector<std::uint64_t> seeds_of_samples(const FrameOptions& options);

/// Copies pixels with mask 0 from `base`, bit for bit, in every channel of `image` but the mattes. The first
/// `data_channels` channels of `image` are valid for every pixel; if `base` lacks such a channel, the channel keeps its
/// values. Channels LAYER.noise and halves.confirmed that `base` lacks become 0. Throws InputError if sizes differ or
/// if `base` lacks another channel.
void keep_base_pixels(const std::vector<std::uint8_t>& mask, const Image& base, std::size_t data_channels,
                      Image& image);

/// Adds the requested colour channels [W/m^2/sr] to `image`: "RGBA", "layers" or a layer's name; and the channels of
/// add_variance_channels(). The sum of the layers in the order of kLayerNames, in float32, is exactly R G B.
void add_colour_channels(const LayerImage& layers, const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
