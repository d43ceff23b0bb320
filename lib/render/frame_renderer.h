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
  int samples = 16;  ///< per pixel; with halves even: half of them in each
  /// Keep two halves apart, independent of each other and of any frame without halves, whatever its seed: a reference.
  bool halves = false;
  double target_error = 0;    ///< > 0: double the samples until the estimated relative RMSE is below
  int max_samples = 1 << 20;  ///< never more than this for target_error
  /// > 0: after `samples` everywhere, more where pixels are uncertain (lib/render/adaptive_frame.h).
  double pixel_error = 0;
  /// > 0: samples are added, as pixel_error shares them out, until noise is below this, in codes (FrameNoise). Needs
  /// pixel_error.
  double seen_error = 0;
  int adaptive_limit = 1024;
  /// The frame will be filtered (lib/filter): noise that counts for pixel_error is that of light which passes the
  /// filter, layer specular.
  bool for_filter = false;
  /// With pixel_error: light that one sample alone claims is shared out among the pixels around, of a masked frame
  /// those of the mask (lib/render/spread_outliers.h).
  bool spread_outliers = false;
  bool sample_halves = false;            ///< keep LayerImage::sample_halves
  const KnownLight* known = nullptr;     ///< where paths may end
  std::vector<std::uint8_t> mask;        ///< by pixel, 0: leave it out; empty: all pixels
  std::function<void(double)> progress;  ///< called with [0, 1]; may be empty
};

/// Mean radiance by layer and pixel of one half (or of all samples).
struct LayerImage {
  int width = 0, height = 0, samples = 0;
  bool media = false;                       ///< of a scene with media: "layers" holds the layer volume too
  std::vector<Layers> pixels;               ///< width * height, top row first
  std::vector<SampleHalves> sample_halves;  ///< of the same pixels; empty unless asked for
  /// By layer the variance of a pixel's mean over the mean square of SampleHalves::difference (NoiseCheck::shares).
  std::array<double, kLayerCount> difference_share{1, 1, 1, 1, 1, 1};
  SampleHalves* halves_of(std::size_t pixel) { return sample_halves.empty() ? nullptr : &sample_halves[pixel]; }
};

struct RenderedFrame {
  LayerImage mean;     ///< over all samples
  LayerImage half[2];  ///< empty unless halves or target_error
  RayCounts rays;
  RayCounts noise_rays;          ///< of the pixels that were rendered twice, the second time
  double samples_per_pixel = 0;  ///< mean over pixels
  FrameNoise noise;              ///< what it still has
  double at_limit = 0;           ///< share of the pixels that have adaptive_limit samples
  double spread = 0;             ///< share of the light that FrameOptions::spread_outliers moved
  /// RMSE of the mean over pixels and channels [radiance], estimated from the halves' difference; < 0: unknown.
  double own_rmse = -1;
  double mean_radiance = 0;  ///< over pixels and channels
};

/// Box filter of one pixel; every sample of a pixel is a stratified position in it. Deterministic for any
/// number of threads.
RenderedFrame render_frame(const RenderScene& scene, const CameraView& view, const FrameOptions& options);

/// Puts pixels that the mask leaves out (0) back to those of `base`, bit for bit, in every channel of `image`. The
/// first `data_channels` of them hold for every pixel and stay where `base` lacks them. Where it lacks LAYER.noise its
/// light is known: no noise. Throws InputError naming what differs if sizes or channels do not fit.
void keep_base_pixels(const std::vector<std::uint8_t>& mask, const Image& base, std::size_t data_channels,
                      Image& image);

/// Adds to `image` the colour channels asked for: "RGBA", "layers" or a layer's name. The sum of the layers
/// in the order of kLayerNames, in float32, is R G B exactly. Also what add_variance_channels() adds.
void add_colour_channels(const LayerImage& layers, const std::vector<std::string>& channels, Image& image);

/// Data channels of one ray through each pixel's centre: "Z", "N", "P", "id", "albedo", "motion" (forward
/// and backward: pixels, +u right, +v up; zero where nothing is seen). N is the normal that light is computed with,
/// normal map included; albedo is that of the textures over a pixel. A surface of alpha mode BLEND is met or passed by
/// chance, once for a pixel. `next` and `previous` are the scene one frame later and earlier with their cameras; needed
/// for motion only.
struct NeighbourFrame {
  const SceneFrame* frame = nullptr;
  const CameraView* view = nullptr;
};
void add_data_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       const NeighbourFrame& next, const NeighbourFrame& previous, Image& image);

/// Channel groups that may be asked for; throws InputError that lists them if one of `channels` is not among them.
void check_channels(const std::vector<std::string>& channels);

}  // namespace tempolux
