#include "lib/render/adaptive_frame.h"

#include "lib/render/pixel_noise.h"

namespace tempolux {

void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options, RenderedFrame& frame) {
  LayerImage& image = frame.mean;
  PixelNoise noise(view, options);
  const int first = options.samples;
  FrameOptions around = options;
  around.mask = noise.looked_at();
  for_each_pixel(view, around, frame.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    PixelSum half[2];
    half[0].for_filter = half[1].for_filter = options.for_filter;
    for_each_sample(scene, view, options.seed, options.known, pixel, x, y, 0, first, image.halves_of(pixel), counts,
                    [&](int s, const Layers& sample) { half[s < noise.first_half() ? 0 : 1].add(sample); });
    noise.note(pixel, half[0], half[1]);
    join(half[0], 0, noise.first_half(), image.pixels[pixel]);
    if (first > noise.first_half()) join(half[1], noise.first_half(), first - noise.first_half(), image.pixels[pixel]);
  });
  const std::vector<int> missing = noise.missing_samples();
  for_each_pixel(view, options, frame.rays, options.progress, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    const int count = missing[pixel];
    if (count > 0)
      join(sample_pixel(scene, view, options.seed, options.known, pixel, x, y, first, count, image.halves_of(pixel), counts), first, count,
           image.pixels[pixel]);
  });
  double further = 0;
  for (const int count : missing) further += count;
  image.samples = first;
  frame.samples_per_pixel = first + further / double(std::max<std::size_t>(1, image.pixels.size()));
}

}  // namespace tempolux
