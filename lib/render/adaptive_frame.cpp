#include "lib/render/adaptive_frame.h"

#include "lib/render/pixel_noise.h"

namespace tempolux {
namespace {

/// Means over a pixel's first samples of what more samples are joined to part by part. LayerImage holds their sum with the part `own`.
struct FirstParts {
  Layers own, lit, onward;
};

Layers sum_of(const FirstParts& parts) { return PathParts{parts.own, parts.lit, parts.onward}.sum(); }

}  // namespace

void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options, RenderedFrame& frame) {
  LayerImage& image = frame.mean;
  PixelNoise noise(view, options);
  const int first = options.samples;
  FrameOptions around = options;
  around.mask = noise.looked_at();
  ParallelArray<FirstParts> parts(image.pixels.size());
  for_each_pixel(view, around, frame.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    PixelSum half[2];
    half[0].for_filter = half[1].for_filter = options.for_filter;
    const std::uint64_t before = counts.onward;
    for_each_sample(scene, view, options.seed, options.known, pixel, x, y, 0, {first, first, first}, image.halves_of(pixel), counts,
                    [&](int s, const PathParts& sample) { half[s < noise.first_half() ? 0 : 1].add(sample); });
    noise.note(pixel, half[0], half[1], counts.onward - before);
    FirstParts& means = parts[pixel];
    const auto join_halves = [&](LayersT<double> PixelSum::*part, Layers& mean) {
      join(half[0].*part, 0, noise.first_half(), mean);
      join(half[1].*part, noise.first_half(), first - noise.first_half(), mean);
    };
    join_halves(&PixelSum::own, means.own);
    join_halves(&PixelSum::lit, means.lit);
    join_halves(&PixelSum::onward, means.onward);
  });
  const std::vector<PartCounts> missing = noise.missing_samples();
  for_each_pixel(view, around, frame.rays, options.progress, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    FirstParts& means = parts[pixel];
    const PartCounts& more = missing[pixel];
    if (more.own > 0 && (options.mask.empty() || options.mask[pixel])) {
      const PixelSum sum = sample_pixel(scene, view, options.seed, options.known, pixel, x, y, first, more, image.halves_of(pixel), counts);
      join(sum.own, first, more.own, means.own);
      join(sum.lit, first, more.lit, means.lit);
      join(sum.onward, first, more.onward, means.onward);
    }
    image.pixels[pixel] = sum_of(means);
  });
  double further = 0;
  for (const PartCounts& count : missing) further += count.own;
  image.samples = first;
  frame.samples_per_pixel = first + further / double(std::max<std::size_t>(1, image.pixels.size()));
}

}  // namespace tempolux
