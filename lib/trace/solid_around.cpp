#include "lib/trace/solid_around.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace tempolux {
namespace {

constexpr int kRays = 16;
constexpr float kGolden = 2.39996323f;  ///< radians

bool absorbs_light(const MaterialValues& m) {
  const Rgb color = m.attenuation_color;
  return m.transmission > 0 && !m.thin_walled && m.attenuation_distance < INFINITY &&
         std::min({color.r, color.g, color.b}) < 1;
}

}  // namespace

SolidAround::SolidAround(const Tracer& tracer) : tracer_(tracer) {
  for (const Material& material : tracer.frame().materials) absorbs_.push_back(absorbs_light(material));
  any_ = std::ranges::find(absorbs_, char(true)) != absorbs_.end();
}

std::uint32_t SolidAround::operator()(Vec3 place, Vec3 normal, float offset) const {
  if (!any_) return kNone;
  std::array<Ray, kRays> rays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float z = 1 - (2 * float(i) + 1) / kRays, r = std::sqrt(1 - z * z), phi = kGolden * float(i);
    Vec3 direction{r * std::cos(phi), r * std::sin(phi), z};
    if (dot(direction, normal) < 0) direction -= normal * (2 * dot(direction, normal));
    rays[i] = {place + normal * offset, direction, 0, INFINITY};
  }
  std::array<Hit, kRays> hits{};
  tracer_.intersect(rays, hits);
  int fronts = 0;
  std::vector<std::pair<std::uint32_t, int>> backs;  // material, number
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].surface == kNone) continue;
    const SurfacePoint point = tracer_.surface_point(hits[i]);
    if (!absorbs_[point.material]) continue;
    if (dot(point.normal_geometric, rays[i].direction) < 0) {
      ++fronts;
      continue;
    }
    const auto same = std::ranges::find(backs, point.material, [](const auto& b) { return b.first; });
    if (same != backs.end()) ++same->second;
    else backs.emplace_back(point.material, 1);
  }
  const auto most = std::ranges::max_element(backs, {}, [](const auto& b) { return b.second; });
  return most != backs.end() && most->second > fronts && 4 * most->second >= kRays ? most->first : kNone;
}

}  // namespace tempolux
