#include "lib/gather/gather_directions.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/material/seen_side.h"

namespace tempolux {
namespace {

constexpr int kTile = 4;  ///< sectors followed together: two rings of four cells form a packet of rays

/// Step between successive rays of a cell, modulo 1: any number of rays fills the cell uniformly [R2 of Roberts 2018,
/// with a random start].
constexpr Vec2 kStep{0.7548777f, 0.5698403f};
float frac(float x) { return std::min(x - std::floor(x), kOneMinusEpsilon); }

}  // namespace

GatherStrata::GatherStrata(int rings_, int sectors_) : rings(rings_), sectors(sectors_) {
  for (int first = 0; first < sectors; first += kTile)
    for (int j = 0; j < rings; ++j)
      for (int k = first; k < std::min(first + kTile, sectors); ++k) order.push_back(std::uint32_t(j * sectors + k));
}

GatherStrata::GatherStrata(int rays) {
  const int count = std::max(1, int(std::lround(std::sqrt(double(rays) / M_PI))));
  *this = GatherStrata(count, std::max(3, int(std::lround(double(rays) / count))));
}

GatherDirections::GatherDirections(const SurfacePoint& from, Vec3 normal, int rings, int sectors, std::uint64_t key)
    : from_(from),
      frame_(normal),
      geometric_(face_forward(from.normal_geometric, normal)),
      rings_(rings),
      sectors_(sectors),
      key_(key) {}

bool GatherDirections::aim(std::uint32_t cell, std::uint32_t draw, Ray& ray, std::uint64_t& ray_key) const {
  const PathRandom random(key_, cell);
  const Vec2 first = random.get2(0, Purpose::gather);
  const Vec2 u{frac(first.x + float(draw) * kStep.x), frac(first.y + float(draw) * kStep.y)};
  const auto sectors = std::uint32_t(sectors_);
  const float sin2 = (float(cell / sectors) + u.x) / float(rings_);
  const float phi = 2 * kPi * (float(cell % sectors) + u.y) / float(sectors);
  const float sine = std::sqrt(sin2), cosine = std::sqrt(std::max(1e-6f, 1 - sin2));
  const Vec3 travel = frame_.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
  if (!(dot(travel, geometric_) > 0)) return false;
  ray = spawn_ray(from_, travel);
  ray_key = random.bits(1, Purpose::gather, draw);
  return true;
}

}  // namespace tempolux
