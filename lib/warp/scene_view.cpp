#include "lib/warp/scene_view.h"

#include <array>

#include "lib/core/parallel.h"
#include "lib/material/surface_material.h"

namespace tempolux {
namespace {

constexpr std::size_t kTogether = 8;  // rays in a packet

}  // namespace

SceneView::SceneView(const Tracer& tracer, const CameraView& view)
    : tracer_(tracer), view_(view), camera_(view.world_to_camera(), view.world_to_ndc(), view.width(), view.height()) {
  const std::size_t pixels = std::size_t(view.width()) * std::size_t(view.height());
  seen_ = {view.width(), view.height(), std::vector<float>(pixels), std::vector<std::uint32_t>(pixels),
           std::vector<Vec3>(pixels)};
  hits_.resize(pixels);
  parallel_chunks(pixels, 4096, [&](std::size_t first, std::size_t last) {
    std::array<Ray, kTogether> rays;
    for (std::size_t i = first; i < last; i += kTogether) {
      const std::size_t count = std::min(kTogether, last - i);
      for (std::size_t j = 0; j < count; ++j)
        rays[j] = view_.middle(int((i + j) % std::size_t(view.width())), int((i + j) / std::size_t(view.width())));
      tracer_.intersect(std::span(rays).first(count), std::span(hits_).subspan(i, count));
      for (std::size_t j = 0; j < count; ++j) {
        const FacePoint point = point_of(hits_[i + j], rays[j]);
        seen_.depth[i + j] = point.depth;
        seen_.object[i + j] = point.object;
        seen_.normal[i + j] = point.normal;
      }
    }
  });
}

FacePoint SceneView::point_of(const Hit& hit, const Ray& ray) const {
  if (hit.surface == kNone) return {INFINITY, kNoObject, {}};
  SurfacePoint point = tracer_.surface_point(hit);
  const RayCone cone = view_.cone();
  // a normal map bends the normal
  const SurfaceMaterial material(tracer_.frame(), point, cone.width + cone.spread * hit.t);
  const Vec3 normal = dot(point.normal, ray.direction) > 0 ? -point.normal : point.normal;
  return {float(view_.depth(point.position)), point.object, normal};
}

void SceneView::look(std::span<const RasterPoint> at, FacePoint* points) const {
  std::array<Ray, kTogether> rays;
  std::array<Hit, kTogether> hits;
  for (std::size_t i = 0; i < at.size(); i += kTogether) {
    const std::size_t count = std::min(kTogether, at.size() - i);
    for (std::size_t j = 0; j < count; ++j) rays[j] = view_.pinhole({float(at[i + j].x), float(at[i + j].y)});
    hits.fill({});
    tracer_.intersect(std::span(rays).first(count), std::span(hits).first(count));
    for (std::size_t j = 0; j < count; ++j) points[i + j] = point_of(hits[j], rays[j]);
  }
}

std::vector<std::uint8_t> SceneView::gloss() const {
  const SceneFrame& frame = tracer_.frame();
  std::vector<std::uint8_t> of_material, of_pixel(hits_.size());
  for (const Material& material : frame.materials) of_material.push_back(lobes_of(material).specular);
  for (std::size_t p = 0; p < hits_.size(); ++p)
    if (hits_[p].surface != kNone) of_pixel[p] = of_material[frame.surfaces[hits_[p].surface].material];
  return of_pixel;
}

void SceneView::add_channels(const std::vector<std::string>& groups, Image& image) const {
  const auto asked = [&](const char* group) { return std::find(groups.begin(), groups.end(), group) != groups.end(); };
  if (asked("Z")) image.add("Z").values = seen_.depth;
  if (asked("N"))
    for (const auto& [name, component] : {std::pair{"N.X", &Vec3::x}, {"N.Y", &Vec3::y}, {"N.Z", &Vec3::z}}) {
      std::vector<float>& values = image.add(name).values;
      for (std::size_t p = 0; p < values.size(); ++p) values[p] = seen_.normal[p].*component;
    }
  if (asked("id")) image.add_ids("id.object").ids = seen_.object;
}

}  // namespace tempolux
