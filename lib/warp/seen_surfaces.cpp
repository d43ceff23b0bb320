#include "lib/warp/seen_surfaces.h"

#include <cmath>

#include "formats/error.h"
#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr float kNothingDepth = 1e10f;   // what Blender writes where nothing is

FacePoint point_at(const SeenSurfaces& seen, std::size_t p) {
  return {seen.depth[p], seen.object_at(p), seen.normal_at(p)};
}

/// |n . r| of a surface seen at a raster position; 1 if its normal is not known.
float facing(const FrameCamera& camera, Vec3 normal, double x, double y) {
  if (!(length2(normal) > 0)) return 1;
  const Vec3 n = Vec3(camera.camera_from_world().direction(Vec3d(normal)));
  if (camera.orthographic()) return std::abs(n.z);
  const Vec3 ray = Vec3(camera.direction({x, y}));
  return std::abs(dot(ray, n)) / length(ray);
}

const Channel* first_of(const Image& image, const std::string& ours, std::initializer_list<const char*> endings) {
  if (const Channel* channel = image.find(ours)) return channel;
  for (const char* ending : endings)
    for (const Channel& channel : image.channels)
      if (channel.name.ends_with(ending)) return &channel;
  return nullptr;
}

}  // namespace

std::vector<std::uint8_t> whole_pixels(const SeenSurfaces& seen, const FrameCamera& camera) {
  const auto width = std::size_t(seen.width), height = std::size_t(seen.height);
  const float angle = camera.orthographic() ? 0 : float(camera.pixel_width());
  std::vector<float> tolerance(seen.pixel_count());
  parallel_chunks(height, 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first, p = first * width; y < last; ++y)
      for (std::size_t x = 0; x < width; ++x, ++p)
        tolerance[p] = depth_tolerance(angle, facing(camera, seen.normal_at(p), double(x) + 0.5, double(y) + 0.5));
  });
  // A bit for each neighbour that shows another face: right, and the three below.
  std::vector<std::uint8_t> ends(seen.pixel_count());
  parallel_chunks(height, 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first, p = first * width; y < last; ++y)
      for (std::size_t x = 0; x < width; ++x, ++p) {
        const FacePoint here = point_at(seen, p);
        // The larger tolerance of the two: the same answer from either side.
        const auto differs = [&](std::size_t q) { return !same_face(here, point_at(seen, q), std::max(tolerance[p], tolerance[q])); };
        std::uint8_t bits = 0;
        if (x + 1 < width && differs(p + 1)) bits |= 1;
        if (y + 1 < height) {
          if (x > 0 && differs(p + width - 1)) bits |= 2;
          if (differs(p + width)) bits |= 4;
          if (x + 1 < width && differs(p + width + 1)) bits |= 8;
        }
        ends[p] = bits;
      }
  });
  std::vector<std::uint8_t> whole(seen.pixel_count());
  parallel_chunks(height, 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first, p = first * width; y < last; ++y)
      for (std::size_t x = 0; x < width; ++x, ++p) {
        bool end = ends[p] != 0 || (x > 0 && (ends[p - 1] & 1));
        if (y > 0) end |= (ends[p - width] & 4) || (x > 0 && (ends[p - width - 1] & 8)) || (x + 1 < width && (ends[p - width + 1] & 2));
        whole[p] = !end;
      }
  });
  return whole;
}

SeenSurfaces seen_in(const Image& image, const std::string& name) {
  const Channel* depth = first_of(image, "Z", {"depth.Z", "Depth.Z", ".Z.Z", "depth.z"});
  if (!depth || depth->values.empty())
    throw InputError(name + ": has no channel Z; how far away its pixels are must be known: render it with Z");
  SeenSurfaces seen{image.width, image.height, depth->values, {}, {}};
  for (std::size_t p = 0; p < seen.depth.size(); ++p) {
    float& z = seen.depth[p];
    if (!(z < kNothingDepth)) z = INFINITY;
    else if (!(z > 0) || std::isnan(z))
      throw InputError(name + ": channel " + depth->name + ": pixel (" + std::to_string(p % std::size_t(image.width)) +
                       ", " + std::to_string(p / std::size_t(image.width)) + "): depth is not above 0");
  }
  if (const Channel* id = image.find("id.object"); id && !id->ids.empty()) seen.object = id->ids;
  const Channel* n[3] = {first_of(image, "N.X", {".Normal.X"}), first_of(image, "N.Y", {".Normal.Y"}),
                         first_of(image, "N.Z", {".Normal.Z"})};
  if (n[0] && n[1] && n[2] && !n[0]->values.empty() && !n[1]->values.empty() && !n[2]->values.empty()) {
    seen.normal.resize(seen.depth.size());
    for (std::size_t p = 0; p < seen.normal.size(); ++p)
      seen.normal[p] = {n[0]->values[p], n[1]->values[p], n[2]->values[p]};
  }
  return seen;
}

}  // namespace tempolux
