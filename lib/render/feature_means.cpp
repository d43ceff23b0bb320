#include "lib/render/feature_means.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "lib/core/parallel_each.h"
#include "lib/image/channel_groups.h"
#include "lib/image/pixel_surfaces.h"
#include "lib/material/diffuse_transmission.h"
#include "lib/render/shutter.h"

namespace tempolux {
namespace {

constexpr std::uint64_t kKey = 0x616c6265646full;  ///< of the rays' random numbers

constexpr std::size_t kFeatures = 7;
constexpr std::array<const char*, kFeatures> kNames{"albedo.R", "albedo.G", "albedo.B", "N.X",
                                                    "N.Y",      "N.Z",      "inverse_Z"};
constexpr std::size_t kAlbedo = 3;  ///< the first features

/// The features of what a ray meets first; 0 where it meets nothing.
std::array<float, kFeatures> features_of(const SeenNow& now, const Ray& ray) {
  Hit hit;
  if (!now.scene.tracer.intersect(ray, hit)) return {};
  const RayCone cone = now.view.cone();
  SurfacePoint point = now.scene.tracer.surface_point(hit);
  const SurfaceMaterial material(now.scene.frame(), point, cone.width + cone.spread * hit.t);
  const Rgb albedo = diffuse_albedo_of_both(material);
  const Vec3 n = dot(point.normal, ray.direction) > 0 ? -point.normal : point.normal;
  const float inverse_depth = PixelSurfaces::inverse_depth(float(now.view.depth(point.position)));
  return {albedo.r, albedo.g, albedo.b, n.x, n.y, n.z, inverse_depth};
}

}  // namespace

void add_feature_means(const RenderScene& scene, const CameraView& view, const Shutter* shutter,
                       std::span<const std::uint8_t> edges, const std::vector<std::string>& channels, Image& image) {
  const bool all = asked(channels, "coverage");
  std::array<float*, kFeatures> means{}, errors{};  // null: the image does not have the channel
  std::array<float*, kAlbedo> albedo{};
  for (std::size_t f = 0; f < kFeatures; ++f) {
    if (all) means[f] = image.add(std::string("coverage.mean.") + kNames[f]).values.data();
    if (all) errors[f] = image.add(std::string("coverage.error.") + kNames[f]).values.data();
  }
  for (std::size_t f = 0; f < kAlbedo && edges.empty(); ++f)
    if (Channel* const channel = image.find(kNames[f])) albedo[f] = channel->values.data();
  if (!all && std::ranges::none_of(albedo, [](const float* plane) { return plane != nullptr; })) return;
  constexpr auto kCount = float(kMeanRays);
  parallel_pixels(view.width(), view.height(), [&](int x, int y, std::size_t p) {
    if (!edges.empty() && !edges[p]) {
      const auto seen = features_of({scene, view}, view.ray(CameraSample{{float(x) + 0.5f, float(y) + 0.5f}}));
      for (std::size_t f = 0; f < kFeatures; ++f) means[f][p] = seen[f];
      return;
    }
    // Squares are those of differences to the first ray: they are exactly 0 where all rays see the same.
    std::array<float, kFeatures> first{}, sum{}, off{}, square{};
    for (std::uint32_t i = 0; i < std::uint32_t(kMeanRays); ++i) {
      const PixelRandom random(kKey, p, i);
      const SeenNow now = seen_now({scene, view}, shutter, random);
      const auto seen = features_of(now, now.view.ray(sample_of_pixel(now.view, x, y, random)));
      if (i == 0) first = seen;
      for (std::size_t f = 0; f < kFeatures; ++f) {
        const float d = seen[f] - first[f];
        sum[f] += seen[f], off[f] += d, square[f] += d * d;
      }
    }
    for (std::size_t f = 0; f < kFeatures; ++f) {
      if (means[f]) means[f][p] = sum[f] / kCount;
      if (f < kAlbedo && albedo[f]) albedo[f][p] = sum[f] / kCount;
      if (errors[f]) errors[f][p] = std::sqrt(std::max(0.0f, square[f] - off[f] * off[f] / kCount)) / kCount;
    }
  });
}

}  // namespace tempolux
