#include "lib/render/adaptive_frame.h"

#include <cmath>
#include <numeric>

#include "lib/core/parallel_each.h"
#include "lib/render/frame_noise.h"
#include "lib/render/pixel_noise.h"
#include "lib/render/spread_outliers.h"

namespace tempolux {
namespace {

/// The passes of samples of one frame.
class AdaptiveFrame {
 public:
  AdaptiveFrame(const RenderScene& scene, const CameraView& view, const FrameOptions& options, RenderedFrame& frame)
      : view_(view),
        options_(options),
        camera_{scene, view, options.known, options.seed, options.shutter},
        frame_(frame),
        noise_(view, options),
        check_(view, options.seed, options.mask),
        camera_again_{scene, view, options.known, check_.seed(), options.shutter},
        again_rays_(check_.size()),
        counts_(frame.mean.pixels.size(), noise_.first()),
        parts_(frame.mean.pixels.size()),
        brightest_(options.spread_outliers ? frame.mean.pixels.size() : 0) {}
  void render() {
    take_first();
    if (options_.seen_error > 0) reach_seen_error();
    else take_further(1, options_.progress), put_together();
    finish();
  }

 private:
  void take_first();
  std::uint64_t take_further(double times, const std::function<void(double)>& progress);
  void take_again(const PixelPass& pass);
  void put_together();
  void spread();
  void note_confirmed(std::size_t pixel, const Layers& before);
  double noise_left() const;
  double noise_goal() const;
  void reach_seen_error();
  void finish();
  bool shown(std::size_t pixel) const { return options_.mask.empty() || options_.mask[pixel]; }

  const CameraView& view_;
  const FrameOptions& options_;
  const CameraSampler camera_;
  RenderedFrame& frame_;
  PixelNoise noise_;
  NoiseCheck check_;
  const CameraSampler camera_again_;           ///< of the second rendering
  std::vector<RayCounts> again_rays_;          ///< rays of the second rendering, by slot (NoiseCheck::slot)
  std::vector<PartCounts> counts_;             ///< numbers of samples of each pixel, by part
  ParallelArray<PathParts> parts_;             ///< means over these samples
  ParallelArray<BrightestSamples> brightest_;  ///< empty unless outliers are spread
};

/// Repeats a pass with other random numbers if the pixel is rendered twice (NoiseCheck).
void AdaptiveFrame::take_again(const PixelPass& pass) {
  const std::uint32_t slot = check_.slot(pass.x, pass.y);
  if (slot == kNone || !shown(pass.pixel)) return;
  join_parts(sample_pixel(camera_again_, pass, &check_.again_halves(slot), again_rays_[slot]), pass.first, pass.count,
             check_.again(slot));
}

/// Takes the first samples of all pixels whose noise is looked at.
void AdaptiveFrame::take_first() {
  LayerImage& image = frame_.mean;
  const PartCounts first = noise_.first();
  const bool spreads = options_.spread_outliers;
  for_each_pixel(view_, noise_.looked_at(), frame_.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    PixelSum half[2];
    const std::uint64_t before = counts.onward;
    const PixelPass pass{pixel, x, y, {}, first};
    for_each_sample(camera_, pass, image.halves_of(pixel), counts, [&](int s, const PathParts& sample) {
      half[pass.half(s)].add(sample);
      if (spreads) brightest_[pixel].note(sample);
    });
    noise_.note(pixel, half[0], half[1], counts.onward - before);
    join_parts(half[0] + half[1], {}, first, parts_[pixel]);
    take_again(pass);
  });
  noise_.all_noted();
}

/// Takes further samples until each pixel has `times` as many as pixel_error asks for. Returns their number of camera
/// rays.
std::uint64_t AdaptiveFrame::take_further(double times, const std::function<void(double)>& progress) {
  const std::uint64_t before = frame_.rays.camera;
  for_each_pixel(view_, options_.mask, frame_.rays, progress, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    PartCounts& have = counts_[pixel];
    const PartCounts more = missing_samples(have, noise_.wanted_at(x, y, times));
    if (more.own == 0) return;
    const PixelPass pass{pixel, x, y, have, more};
    PixelSum sum;
    for_each_sample(camera_, pass, frame_.mean.halves_of(pixel), counts, [&](int, const PathParts& sample) {
      sum.add(sample);
      if (options_.spread_outliers) brightest_[pixel].note(sample);
    });
    join_parts(sum, have, more, parts_[pixel]);
    take_again(pass);
    have = have + more;
  });
  return frame_.rays.camera - before;
}

/// Makes the picture from the means of the parts and measures its noise.
void AdaptiveFrame::put_together() {
  std::vector<Layers>& pixels = frame_.mean.pixels;
  parallel_each(pixels.size(), 4096, [&](std::size_t p) {
    pixels[p] = parts_[p].sum();
    if (!frame_.mean.stored_noise.empty()) frame_.mean.stored_noise[p] = parts_[p].stored_noise;
  });
  if (options_.spread_outliers) spread();
  frame_.noise = check_.measure(
      pixels, [&](std::size_t pixel) { return parts_[pixel].sum(); }, frame_.mean.stored_noise);
}

/// Spreads outliers. Where fewer than kJudges samples of a part exist beside an outlier, takes further samples first.
void AdaptiveFrame::spread() {
  std::vector<Layers>& pixels = frame_.mean.pixels;
  SampledPixels samples{
      frame_.mean.width, frame_.mean.height, parts_, counts_, brightest_, options_.mask, [&](double level) {
        return noise_.error_at(level);
      }};
  const std::vector<double> errors = allowed_errors(samples, pixels);
  const std::vector<std::size_t> judged = pixels_to_judge(samples, pixels, errors);
  for (const std::size_t pixel : judged) samples.further[pixel] = {};
  frame_.rays += parallel_sum<RayCounts>(judged.size(), 64, [&](std::size_t i, RayCounts& rays) {
    const std::size_t pixel = judged[i], width = std::size_t(frame_.mean.width);
    const PartCounts &have = counts_[pixel], more = missing_samples(have, {kJudges, kJudges, kJudges});
    const PixelPass pass{pixel, int(pixel % width), int(pixel / width), have, more};
    FurtherSamples& further = samples.further.at(pixel);
    further.count = more;
    join_parts(sample_pixel(camera_, pass, nullptr, rays), {}, more, further.mean);
  });
  std::vector<Layers> before;
  for (const std::size_t pixel : judged) before.push_back(pixels[pixel]);
  frame_.spread = spread_outliers(samples, errors, pixels);
  std::vector<std::uint8_t>& confirmed = frame_.mean.confirmed;
  confirmed.assign(frame_.mean.sample_halves.size(), 0);
  for (std::size_t i = 0; i < judged.size() && !confirmed.empty(); ++i) note_confirmed(judged[i], before[i]);
}

/// Marks the layer of the pixel's brightest sample as confirmed if spread_outliers took no light from this layer;
/// `before`: the pixel before it. All light of the sample may lie in one half, and without the mark a filter that takes
/// the difference of the halves for noise would remove the light.
void AdaptiveFrame::note_confirmed(std::size_t pixel, const Layers& before) {
  const BrightestSamples& claims = brightest_[pixel];
  const BrightestSample& claim = std::max({claims.own, claims.lit, claims.onward},
                                          [](const auto& a, const auto& b) { return a.brightest < b.brightest; });
  if (channel_sum(frame_.mean.pixels[pixel][claim.layer]) >= channel_sum(before[claim.layer]))
    frame_.mean.confirmed[pixel] |= std::uint8_t(1 << int(claim.layer));
}

/// Noise in codes, or its standard error if the error is larger: one outlier among the pixels that are rendered twice
/// can make the measured noise 0 +- 10.
double AdaptiveFrame::noise_left() const { return std::max(frame_.noise.image.codes, frame_.noise.image.codes_error); }

/// Noise in codes at which sampling stops: seen_error, or, if this is larger, the noise of records and photons with
/// half of seen_error added in quadrature. Further samples cannot reduce the noise of records and photons, and the
/// added half raises the total by at most 15 %.
double AdaptiveFrame::noise_goal() const {
  return std::max(options_.seen_error, std::hypot(frame_.noise.stored_codes, options_.seen_error / 2));
}

/// Adds passes of samples until noise_left() is at most noise_goal(). The noise measured after a pass decides the size
/// of the next one, by error_exponent(). The measurement may be wrong, so a pass aims at no more than four times the
/// samples of the pass before.
void AdaptiveFrame::reach_seen_error() {
  // kLeastTimes: a measurement over 1024 pixels errs by 2.2 %, so less than 3 x 2.2 % of the noise is no certain gain:
  // 1.066^(1 / .64) = 1.1 times the samples.
  constexpr double kMostTimes = 4, kLeastTimes = 1.1;
  constexpr int kMostIdle = 8;  // passes in a row without a sample: all pixels are at their limit or show no noise
  put_together();
  double times = 0.25;
  const double at_first = noise_left();
  for (int idle = 0; frame_.noise.known() && noise_left() > noise_goal() && idle < kMostIdle;) {
    if (options_.progress)
      options_.progress(
          std::clamp(std::log(at_first / noise_left()) / std::log(at_first / options_.seen_error), 0.0, 1.0));
    if (take_further(times, {}) > 0) {
      put_together();
      idle = 0;
    } else {
      ++idle;
    }
    times *= std::clamp(std::pow(noise_left() / noise_goal(), 1 / error_exponent()), kLeastTimes, kMostTimes);
  }
}

void AdaptiveFrame::finish() {
  if (!frame_.mean.sample_halves.empty())
    frame_.mean.difference_share =
        check_.shares(frame_.mean.sample_halves, [&](std::size_t pixel) { return parts_[pixel].sum(); });
  for (const RayCounts& rays : again_rays_) frame_.noise_rays += rays;
  frame_.mean.samples = noise_.first().own;
  for (std::size_t p = 0; p < counts_.size(); ++p) {
    if (options_.camera_samples) frame_.camera_samples.push_back(std::uint32_t(counts_[p].own));
    frame_.samples_per_pixel += counts_[p].own;
    frame_.at_limit += shown(p) && counts_[p].own >= options_.adaptive_limit;
  }
  frame_.samples_per_pixel /= double(counts_.size());
  frame_.at_limit /= double(counts_.size());
}

}  // namespace

void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options,
                     RenderedFrame& frame) {
  AdaptiveFrame(scene, view, options, frame).render();
}

}  // namespace tempolux
