#include "lib/warp/seen_surfaces.h"

#include <array>
#include <cmath>

#include "formats/error.h"
#include "lib/core/parallel_each.h"

namespace tempolux {
namespace {

constexpr float kNothingDepth = 1e10f;  ///< Blender writes this depth where no surface is

FacePoint point_at(const SeenSurfaces& seen, std::size_t p) {
  return {seen.depth[p], seen.object_at(p), seen.normal_at(p)};
}

/// |n . r| of a surface seen at a raster position; 1 if its normal is unknown.
float facing(const FrameCamera& camera, Vec3 normal, double x, double y) {
  if (!(length2(normal) > 0)) return 1;
  const Vec3 n = Vec3(camera.camera_from_world().direction(Vec3d(normal)));
  if (camera.orthographic()) return std::abs(n.z);
  const Vec3 ray = Vec3(camera.direction({x, y}));
  return std::abs(dot(ray, n)) / length(ray);
}

std::string pixel_of(const std::string& name, const std::string& channel, std::size_t p, int width) {
  return name + ": channel " + channel + ": pixel (" + std::to_string(p % std::size_t(width)) + ", " +
         std::to_string(p / std::size_t(width)) + "): ";
}

/// The normal with length 1; 0 stays 0 (unknown). Other programs filter normals, which changes their length.
Vec3 unit_normal(Vec3 n) {
  const float length2_of = length2(n);
  if (std::abs(length2_of - 1) < 1e-3f) return n;  // N from frame-render keeps its bits
  const Vec3d wide(n);
  const double size = length(wide);
  return size > 0 ? Vec3(wide / size) : Vec3{};
}

}  // namespace

std::vector<std::uint8_t> whole_pixels(const SeenSurfaces& seen, const FrameCamera& camera) {
  const int columns = seen.width, rows = seen.height;
  const auto width = std::size_t(columns);
  const float angle = camera.orthographic() ? 0 : float(camera.pixel_width());
  std::vector<float> tolerance(seen.pixel_count());
  parallel_pixels(columns, rows, [&](int x, int y, std::size_t p) {
    tolerance[p] = depth_tolerance(angle, facing(camera, seen.normal_at(p), x + 0.5, y + 0.5));
  });
  // One bit for each of four neighbours (right, and the three below) that shows another face.
  std::vector<std::uint8_t> ends(seen.pixel_count());
  parallel_pixels(columns, rows, [&](int x, int y, std::size_t p) {
    const FacePoint here = point_at(seen, p);
    // The larger of the two tolerances, so that both directions give the same answer.
    const auto differs = [&](std::size_t q) {
      return !same_face(here, point_at(seen, q), std::max(tolerance[p], tolerance[q]));
    };
    std::uint8_t bits = 0;
    if (x + 1 < columns && differs(p + 1)) bits |= 1;
    if (y + 1 < rows) {
      if (x > 0 && differs(p + width - 1)) bits |= 2;
      if (differs(p + width)) bits |= 4;
      if (x + 1 < columns && differs(p + width + 1)) bits |= 8;
    }
    ends[p] = bits;
  });
  std::vector<std::uint8_t> whole(seen.pixel_count());
  parallel_pixels(columns, rows, [&](int x, int y, std::size_t p) {
    bool end = ends[p] != 0 || (x > 0 && (ends[p - 1] & 1));
    if (y > 0)
      end |= (ends[p - width] & 4) || (x > 0 && (ends[p - width - 1] & 8)) ||
             (x + 1 < columns && (ends[p - width + 1] & 2));
    whole[p] = !end;
  });
  return whole;
}

SeenSurfaces seen_in(const Image& image, const std::string& name) {
  const Channel* depth = image.find("Z");
  if (!depth || depth->values.empty())
    throw InputError(name + ": has no channel Z; how far away its pixels are must be known: render it with Z");
  SeenSurfaces seen{image.width, image.height, depth->values, {}, {}};
  for (std::size_t p = 0; p < seen.depth.size(); ++p) {
    float& z = seen.depth[p];
    if (z >= kNothingDepth) z = INFINITY;
    else if (!(z > 0))
      throw InputError(pixel_of(name, "Z", p, image.width) +
                       "depth is not above 0; Z is the distance along the view axis, +inf where nothing is seen");
  }
  if (const Channel* id = image.find("id.object"); id && !id->ids.empty()) seen.object = id->ids;
  const std::array<const Channel*, 3> n{image.find("N.X"), image.find("N.Y"), image.find("N.Z")};
  for (const Channel* component : n)
    if (!component || component->values.empty()) return seen;
  seen.normal.resize(seen.depth.size());
  for (std::size_t p = 0; p < seen.normal.size(); ++p) {
    for (const Channel* component : n)
      if (!std::isfinite(component->values[p]))
        throw InputError(pixel_of(name, component->name, p, image.width) +
                         "not finite; a normal that is not known is 0");
    seen.normal[p] = unit_normal({n[0]->values[p], n[1]->values[p], n[2]->values[p]});
  }
  return seen;
}

}  // namespace tempolux
