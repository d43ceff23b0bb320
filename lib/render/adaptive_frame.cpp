#include "lib/render/adaptive_frame.h"

#include "lib/render/pixel_noise.h"
#include "lib/render/spread_outliers.h"

namespace tempolux {
namespace {

/// Joins the sums over `count` samples of each part to the means over the `first` before.
void join_parts(const PixelSum& sum, const PartCounts& first, const PartCounts& count, PathParts& means) {
  join(sum.own, first.own, count.own, means.own);
  join(sum.lit, first.lit, count.lit, means.lit);
  join(sum.onward, first.onward, count.onward, means.onward);
}

double spread_outliers_of(const PixelNoise& noise, const PartCounts& first, const std::vector<PartCounts>& missing, std::span<const PathParts> parts,
                          std::span<const BrightestSamples> brightest, std::span<const std::uint8_t> mask, LayerImage& image) {
  std::vector<PartCounts> counts(missing);
  for (PartCounts& count : counts) count = {first.own + count.own, first.lit + count.lit, first.onward + count.onward};
  return spread_outliers({image.width, image.height, parts, counts, brightest, mask, [&](double level) { return noise.error_at(level); }}, image.pixels);
}

}  // namespace

void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options, RenderedFrame& frame) {
  LayerImage& image = frame.mean;
  PixelNoise noise(view, options);
  const PartCounts first = noise.first();
  FrameOptions around = options;
  around.mask = noise.looked_at();
  ParallelArray<PathParts> parts(image.pixels.size());
  const bool spreads = options.spread_outliers;
  ParallelArray<BrightestSamples> brightest(spreads ? image.pixels.size() : 0);
  for_each_pixel(view, around, frame.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    PixelSum half[2];
    half[0].for_filter = half[1].for_filter = options.for_filter;
    const std::uint64_t before = counts.onward;
    for_each_sample(scene, view, options, pixel, x, y, {}, first, image.halves_of(pixel), counts,
                    [&](int s, const PathParts& sample) {
                      half[noise.half(s)].add(sample);
                      if (spreads) brightest[pixel].note(sample, options.for_filter);
                    });
    noise.note(pixel, half[0], half[1], counts.onward - before);
    join_parts(half[0] + half[1], {}, first, parts[pixel]);
  });
  const std::vector<PartCounts> missing = noise.missing_samples();
  for_each_pixel(view, around, frame.rays, options.progress, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    const PartCounts& more = missing[pixel];
    if (more.own > 0 && (options.mask.empty() || options.mask[pixel])) {
      PixelSum sum;
      for_each_sample(scene, view, options, pixel, x, y, first, more, image.halves_of(pixel), counts,
                      [&](int, const PathParts& sample) {
                        sum.add(sample);
                        if (spreads) brightest[pixel].note(sample, options.for_filter);
                      });
      join_parts(sum, first, more, parts[pixel]);
    }
    image.pixels[pixel] = parts[pixel].sum();
  });
  if (spreads) frame.spread = spread_outliers_of(noise, first, missing, parts, brightest, options.mask, image);
  double further = 0;
  for (const PartCounts& count : missing) further += count.own;
  image.samples = first.own;
  frame.samples_per_pixel = first.own + further / double(std::max<std::size_t>(1, image.pixels.size()));
}

}  // namespace tempolux
