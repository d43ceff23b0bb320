#include "lib/render/blurred_albedo.h"

#include <array>

#include "lib/core/parallel_each.h"
#include "lib/material/diffuse_transmission.h"
#include "lib/render/shutter.h"

namespace tempolux {
namespace {

constexpr std::uint64_t kKey = 0x616c6265646full;  ///< of the rays' random numbers

Rgb albedo_along(const RenderScene& scene, const CameraView& view, const CameraSample& sample) {
  const Ray ray = view.ray(sample);
  Hit hit;
  if (!scene.tracer.intersect(ray, hit)) return Rgb(0.0f);
  const RayCone cone = view.cone();
  SurfacePoint point = scene.tracer.surface_point(hit);
  const SurfaceMaterial material(scene.frame(), point, cone.width + cone.spread * hit.t);
  return diffuse_albedo_of_both(material);
}

}  // namespace

void blur_albedo(const RenderScene& scene, const CameraView& view, const Shutter* shutter, Image& image) {
  std::array<float*, 3> planes{};
  constexpr std::array<const char*, 3> kNames{"albedo.R", "albedo.G", "albedo.B"};
  for (std::size_t c = 0; c < planes.size(); ++c) {
    Channel* const channel = image.find(kNames[c]);
    if (!channel) return;
    planes[c] = channel->values.data();
  }
  parallel_pixels(view.width(), view.height(), [&](int x, int y, std::size_t p) {
    Rgb sum(0.0f);
    for (std::uint32_t i = 0; i < std::uint32_t(kAlbedoRays); ++i) {
      const PixelRandom random(kKey, p, i);
      const auto [now, through] = seen_now({scene, view}, shutter, random);
      sum += albedo_along(now, through, sample_of_pixel(through, x, y, random));
    }
    const Rgb mean = sum * (1.0f / float(kAlbedoRays));
    planes[0][p] = mean.r, planes[1][p] = mean.g, planes[2][p] = mean.b;
  });
}

}  // namespace tempolux
