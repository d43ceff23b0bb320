#include "lib/filter/surfaces.h"

#include "lib/filter/coverage.h"
#include "lib/filter/picture.h"
#include "lib/filter/rows.h"
#include "lib/filter/surface_weight.h"

namespace tempolux {
namespace {

constexpr float kDarkest = 0.01f;  ///< least albedo: almost black surfaces have almost no light to filter

Plane plane_of(const Image& image, const std::string& name) {
  const Channel* channel = image.find(name);
  if (!channel || channel->values.empty()) return Plane(image.width, image.height);
  Plane plane = Plane::unset(image.width, image.height);
  plane.take(channel->values, image.width);
  return plane;
}

/// For eight pixels: 1 if the pixel and all of its 3 x 3 neighbours are on one surface, else 0. Each pair is compared
/// in both directions. Neighbours outside the picture do not count.
Float8 one_surface_around(const Surfaces& surfaces, int y, std::ptrdiff_t x0) {
  Float8 inside = all8(1);
  for (int dy = std::max(-1, -y); dy <= std::min(1, surfaces.height - 1 - y); ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      Float8 same =
          SurfaceEight(surfaces, y, dy, x0).surface(dx) * SurfaceEight(surfaces, y + dy, -dy, x0 + dx).surface(-dx);
      if (dx < 0 && x0 == 0) same[0] = 1;
      if (const auto last = std::size_t(surfaces.width - 1 - x0); dx > 0 && last < kEight) same[last] = 1;
      inside *= same;
    }
  return inside;
}

}  // namespace

Surfaces::Surfaces(const Image& image, bool seen) : width(image.width), height(image.height) {
  const std::string of = seen && holds(image, "seen.Z") ? "seen." : "";
  nx = plane_of(image, of + "N.X");
  ny = plane_of(image, of + "N.Y");
  nz = plane_of(image, of + "N.Z");
  object = PlaneT<std::uint32_t>(width, height);
  if (const Channel* ids = image.find(of.empty() ? "id.object" : "seen.id"); ids && !ids->ids.empty())
    object.take(ids->ids, width);
  take_depth(image.find(of + "Z"));
  if (!seen || !of.empty()) take_albedo(image, of + "albedo");
  take_edges(image);
}

/// 1 / depth and its slopes, as in PixelSurfaces.
void Surfaces::take_depth(const Channel* z) {
  const bool there = z && !z->values.empty();
  for (Plane* plane : {&w, &w_right, &w_down}) *plane = there ? Plane::unset(width, height) : Plane(width, height);
  if (!there) return;
  for_each_row(height, [&](int y) {
    const float* depth = z->values.data() + std::size_t(y) * std::size_t(width);
    for (int x = 0; x < width; ++x) w.row(y)[x] = PixelSurfaces::inverse_depth(depth[x]);
  });
  for_each_row(height, [&](int y) {
    const float *own = w.row(y), *above = w.row(y - 1), *below = w.row(y + 1);
    const std::uint32_t *here = object.row(y), *object_above = object.row(y - 1), *object_below = object.row(y + 1);
    for (int x = 0; x < width; ++x) {
      const bool before = x > 0 && here[x - 1] == here[x], after = x + 1 < width && here[x + 1] == here[x];
      w_right.row(y)[x] = PixelSurfaces::smaller(own[x] - own[x - 1], before, own[x + 1] - own[x], after);
      const bool upper = y > 0 && object_above[x] == here[x], lower = y + 1 < height && object_below[x] == here[x];
      w_down.row(y)[x] = PixelSurfaces::smaller(own[x] - above[x], upper, below[x] - own[x], lower);
    }
  });
}

void Surfaces::take_albedo(const Image& image, const std::string& name) {
  if (!has_colour(image, name)) return;
  for (std::size_t c = 0; c < 3; ++c) {
    albedo[c] = plane_of(image, channel_name(name, c));
    for_each_row(height, [&](int y) {
      float* rho = albedo[c].row(y);
      for (int x = 0; x < width; ++x) rho[x] = rho[x] >= kDarkest && rho[x] < kLargestLight ? rho[x] : kDarkest;
    });
  }
}

void Surfaces::take_edges(const Image& image) {
  const Coverage coverage(image);
  use = Plane::unset(width, height);
  inside = Plane::unset(width, height);
  for_each_row(height, [&](int y) {
    for (std::size_t x0 = 0; x0 < std::size_t(width); x0 += kEight) {
      const Float8 around = one_surface_around(*this, y, std::ptrdiff_t(x0));
      for (std::size_t i = 0; i < std::min(kEight, std::size_t(width) - x0); ++i) {
        const bool whole = coverage.known() ? coverage.is_whole(int(x0 + i), y) : around[i] != 0;
        use.row(y)[x0 + i] = whole ? 1.0f : 0.0f;
        inside.row(y)[x0 + i] = whole ? around[i] : 0.0f;
      }
    }
  });
}

}  // namespace tempolux
