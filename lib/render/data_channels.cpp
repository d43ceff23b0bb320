#include "lib/render/data_channels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/image/channel_groups.h"
#include "lib/material/diffuse_transmission.h"
#include "lib/material/surface_material.h"
#include "lib/scene/same_surfaces.h"
#include "lib/trace/triangle_hit.h"

namespace tempolux {
namespace {

const std::vector<std::string> kGroups{"RGBA",     "layers", "emission", "specular",   "direct",   "caustic",
                                       "indirect", "volume", "Z",        "N",          "P",        "id",
                                       "albedo",   "motion", "coverage", "influence",  "variance", "diffuse.variance",
                                       "samples",  "halves", "seen",     "cryptomatte"};

/// Finds a surface point again in another frame, where its surface may have moved or been deformed (same_surfaces). The
/// point has the same triangle and barycentric coordinates there.
class OtherFrame {
 public:
  OtherFrame(const NeighbourFrame& other, const SceneFrame& here) : view_(other.view) {
    if (other.frame) there_ = same_surfaces(here, *other.frame);
  }
  /// Motion in pixels, right and up, from raster position `here` to the point's position in the other frame. Zero if
  /// there is no other frame, or if the point is not in front of that frame's camera.
  Vec2 motion(const SurfacePoint& point, std::array<double, 2> here) const {
    const Surface* surface = there_.empty() ? nullptr : there_[point.surface];
    if (!surface) return {};
    const auto& corner = surface->primitive->triangles[point.triangle];
    const auto raster = view_->project(surface->position(corner[0]) * (1 - point.u - point.v) +
                                       surface->position(corner[1]) * point.u + surface->position(corner[2]) * point.v);
    if (!raster) return {};
    return {float((*raster)[0] - here[0]), float(here[1] - (*raster)[1])};
  }

 private:
  const CameraView* view_;
  std::vector<const Surface*> there_;  ///< by surface of this frame; empty without another frame
};

/// Stores numbers[c] in planes[c] at pixel i.
template <std::size_t kCount>
void set(const std::array<float*, kCount>& planes, std::size_t i, const std::array<float, kCount>& numbers) {
  for (std::size_t c = 0; c < kCount; ++c) planes[c][i] = numbers[c];
}

/// The planes of the requested channels. The constructor adds these channels to the image. null: not requested.
struct DataPlanes {
  float* z = nullptr;
  std::array<float*, 3> normal{}, position{}, albedo{};
  std::array<float*, 4> motion{};
  std::uint32_t* id = nullptr;

  DataPlanes(const std::vector<std::string>& channels, Image& image) {
    const auto add = [&](const char* group, float** plane, std::initializer_list<const char*> names) {
      if (!asked(channels, group)) return;
      for (const char* name : names) *plane++ = image.add(name).values.data();
    };
    add("Z", &z, {"Z"});
    add("N", normal.data(), {"N.X", "N.Y", "N.Z"});
    add("P", position.data(), {"P.X", "P.Y", "P.Z"});
    add("albedo", albedo.data(), {"albedo.R", "albedo.G", "albedo.B"});
    add("motion", motion.data(), {"forward.u", "forward.v", "backward.u", "backward.v"});
    if (asked(channels, "id")) id = image.add_ids("id.object").ids.data();
  }
  bool none() const { return !(z || normal[0] || position[0] || albedo[0] || motion[0] || id); }
  /// Stores that pixel i shows no surface: depth infinity, object kNone. The other planes keep 0.
  void set_empty(std::size_t i) const {
    if (z) z[i] = INFINITY;
    if (id) id[i] = kNone;
  }
  /// Stores object, normal and world-space position of pixel i. direction: of the camera ray; origin: world-space
  /// position of the scene space's origin [m].
  void set_surface(std::size_t i, const SurfacePoint& point, Vec3 direction, Vec3d origin) const {
    if (id) id[i] = point.object;
    if (normal[0]) {
      const Vec3 n = dot(point.normal, direction) > 0 ? -point.normal : point.normal;
      set(normal, i, {n.x, n.y, n.z});
    }
    if (position[0]) {
      const Vec3d world = Vec3d(point.position) + origin;
      set(position, i, {float(world.x), float(world.y), float(world.z)});
    }
  }
};

constexpr int kAcross = 4;  ///< places along each side of a pixel: lines as narrow as a quarter of it are averaged

/// Mean reflectance of the Lambert lobe over the part of a pixel that lies on the triangle at its centre: at kAcross^2
/// places, where rays through the pixel meet the triangle's plane (the footprint of ray differentials [Igehy 1999]).
/// The samples of a pixel see this mean. With the value at the centre alone, the filter divides their light by the
/// colour of a line that is narrower than the pixel, and multiplies the filtered light by it: lines become dots.
/// `centre`: raster position; `hit`: what its ray meets; `point`: the surface there. `at_centre`: reflectance there.
Rgb albedo_in_pixel(const SceneFrame& frame, const CameraView& view, Vec2 centre, const Hit& hit,
                    const SurfacePoint& point, Rgb at_centre) {
  const std::optional<MaterialTextures>& textures = frame.materials[point.material].textures;
  if (!textures || !(textures->base_color || textures->metallic_roughness)) return at_centre;
  const Surface& surface = frame.surfaces[hit.surface];
  const auto& corner = surface.primitive->triangles[hit.triangle];
  const Vec3 a = surface.position(corner[0]), b = surface.position(corner[1]), c = surface.position(corner[2]);
  const RayCone cone = view.cone();
  Rgb sum(0.0f);
  int count = 0;
  for (int i = 0; i < kAcross * kAcross; ++i) {
    const Vec2 aside{(float(i % kAcross) + 0.5f) / kAcross - 0.5f, (float(i / kAcross) + 0.5f) / kAcross - 0.5f};
    const Ray ray = view.pinhole({centre.x + aside.x, centre.y + aside.y});
    const TriangleHit met = meet_plane(ray.origin, ray.direction, a, b, c);
    if (!(met.t > 0) || met.outside() || !(met.t < INFINITY)) continue;
    SurfacePoint there = point;
    there.u = met.u, there.v = met.v;
    const SurfaceMaterial material(frame, there, (cone.width + cone.spread * met.t) / kAcross);
    sum += diffuse_albedo_of_both(material);
    ++count;
  }
  return count > 0 ? sum * (1 / float(count)) : at_centre;
}

}  // namespace

void check_channels(const std::vector<std::string>& channels) {
  for (const std::string& name : channels)
    if (std::find(kGroups.begin(), kGroups.end(), name) == kGroups.end()) {
      std::string list;
      for (const std::string& group : kGroups) list += (list.empty() ? "" : ",") + group;
      throw InputError("--channels: '" + name + "' is no channel group; choose from " + list);
    }
}

void add_data_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       const NeighbourFrame& next, const NeighbourFrame& previous, Image& image) {
  const DataPlanes planes(channels, image);
  if (planes.none()) return;
  const bool motion = planes.motion[0];
  const OtherFrame later(motion ? next : NeighbourFrame{}, scene.frame());
  const OtherFrame earlier(motion ? previous : NeighbourFrame{}, scene.frame());
  const RayCone cone = view.cone();
  const auto width = std::size_t(view.width());
  parallel_chunks(image.pixel_count(), 4096, [&](std::size_t first, std::size_t last) {
    std::vector<Vec2> centres;
    for (std::size_t i = first; i < last; ++i) centres.push_back({float(i % width) + 0.5f, float(i / width) + 0.5f});
    const CameraRays rays(scene.tracer, view, centres);
    for (std::size_t i = first, k = 0; i < last; ++i, ++k) {
      const Hit& hit = rays.hits[k];
      if (hit.surface == kNone) {
        planes.set_empty(i);
        continue;
      }
      SurfacePoint point = scene.tracer.surface_point(hit);
      const SurfaceMaterial material(scene.frame(), point, cone.width + cone.spread * hit.t);
      planes.set_surface(i, point, rays.rays[k].direction, scene.frame().origin);
      if (planes.z) planes.z[i] = float(view.depth(point.position));
      if (planes.albedo[0]) {
        const Rgb rho = albedo_in_pixel(scene.frame(), view, centres[k], hit, point, diffuse_albedo_of_both(material));
        set(planes.albedo, i, {rho.r, rho.g, rho.b});
      }
      if (motion) {
        const auto [x, y] = centres[k];
        const std::array<double, 2> here = view.project(point.position).value_or(std::array{double(x), double(y)});
        const Vec2 f = later.motion(point, here), b = earlier.motion(point, here);
        set(planes.motion, i, {f.x, f.y, b.x, b.y});
      }
    }
  });
}

}  // namespace tempolux
