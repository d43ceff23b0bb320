#include "lib/audit/specular_hits.h"

#include <algorithm>
#include <cmath>

#include "formats/octahedral.h"
#include "lib/core/arrays.h"
#include "lib/core/parallel_each.h"
#include "lib/points/footprint_density.h"
#include "lib/audit/photon_splats.h"
#include "lib/render/pixels_around.h"
#include "lib/transport/roulette.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kLongest = 64;  ///< events S of a path
constexpr std::uint32_t kSure = 3;      ///< events before Russian roulette, as in the path tracer
constexpr float kMostSurvival = 0.95f;
/// Radius of a disc in widths of a pixel's footprint, times the root of the number of pixels per path. A disc of radius
/// r at the edge of a surface of width s extends beyond the surface, which loses about .85 r / s of its light: 1 % of a
/// wall of 20 pixels at one path per pixel. Smaller discs meet fewer photons.
constexpr float kFootprints = 0.25f;
constexpr float kSameSide = 0.9f;   ///< cosine of normals below which a photon lies on another surface
constexpr float kOffPlane = 0.25f;  ///< radii off the plane at which a photon lies on another surface

std::uint64_t cell_of(int size, std::int64_t x, std::int64_t y, std::int64_t z) {
  return mix64(mix64(mix64(std::uint64_t(size) * 0x9e3779b97f4a7c15ull + std::uint64_t(x)) + std::uint64_t(y)) +
               std::uint64_t(z));
}

std::int64_t index_in(float coordinate, int size) {
  return std::int64_t(std::floor(std::ldexp(double(coordinate), -size)));
}

}  // namespace

SpecularHits::SpecularHits(const RenderScene& scene, const CameraView& view, std::span<const std::uint8_t> mask,
                           std::size_t count, std::uint64_t seed)
    : tracer_(scene.tracer) {
  const auto width = std::size_t(view.width());
  std::vector<std::uint8_t> middles(width * std::size_t(view.height()));
  parallel_each(middles.size(), 4096, [&](std::size_t p) {
    Hit hit;
    middles[p] = scene.tracer.intersect(view.middle(int(p % width), int(p / width)), hit) &&
                 lobes_of(scene.frame().materials[scene.tracer.surface_point(hit).material]).specular;
  });
  const auto pixels =
      parallel_found<std::size_t>(middles.size(), 4096, [&](std::size_t p, std::vector<std::size_t>& found) {
        bool around = middles[p];
        for_each_around(view.width(), view.height(), int(p % width), int(p / width), 1,
                        [&](std::size_t at, int, int) { around |= middles[at] != 0; });
        if ((mask.empty() || mask[p]) && around) found.push_back(p);
      });
  if (pixels.empty() || count == 0) return;
  const double pixels_of_path = double(pixels.size()) / double(count);
  hits_ = parallel_found<HitPlace>(count, 64, [&](std::size_t i, std::vector<HitPlace>& found) {
    const PixelRandom random(seed, i, 0);
    const double at = double(i) + double(PathRandom(seed ^ 1, i).get1(0, Purpose::pixel));
    const std::size_t pixel = pixels[std::min(pixels.size() - 1, std::size_t(at * pixels_of_path))];
    follow(scene, view.ray(sample_of_pixel(view, int(pixel % width), int(pixel / width), random)), random, view.cone(),
           pixels_of_path, found);
  });
  sort_into_cells();
}

/// Follows the events S of one camera path.
void SpecularHits::follow(const RenderScene& scene, const Ray& ray, const PixelRandom& random, RayCone cone,
                          double pixels_of_path, std::vector<HitPlace>& found) const {
  const Rgb weight{float(pixels_of_path)};
  const float widen = float(std::sqrt(std::max(1.0, pixels_of_path)));
  SpecularChain chain(scene.tracer, ray, scene.camera_inside);
  while (chain.events() < kLongest && chain.meet()) {
    const std::uint32_t bounce = chain.events();
    cone.advance(chain.leg());
    const Vec3 smooth = chain.point().normal;
    const ShadingPoint& x = chain.shade(cone.width);
    if (chain.material().unlit) return;
    if (bounce > 0 && x.bsdf.has_diffuse()) {
      const float radius = kFootprints * widen * cone.width;
      const auto add = [&](const ShadingPoint& side) {
        found.push_back({side, chain.ray().origin, side.normal_geometric, smooth,
                         weight * chain.passed() * side.bsdf.diffuse_reflectance(side.wo_local) *
                             (kInvPi * kInvPi / (radius * radius)),
                         radius});
      };
      add(x);
      if (transmits_diffusely(chain.material()))
        add(ShadingPoint::on_far_side(chain.point(), -chain.ray().direction, chain.material()));
    }
    if (!x.bsdf.has_specular()) return;
    const Scattered next(x, random.get1(bounce, Purpose::lobe), random.get2(bounce, Purpose::scatter));
    const float side = next.sample.transmitted ? -1.0f : 1.0f;
    if (next.sample.diffuse || is_black(next.sample.weight) || side * dot(next.travel, x.normal_geometric) <= 0) return;
    chain.go_on(next);
    if (bounce >= kSure && !survives(chain.passed(), kMostSurvival, random.get1(bounce, Purpose::roulette))) return;
  }
}

void SpecularHits::sort_into_cells() {
  for (std::uint32_t i = 0; i < hits_.size(); ++i) {
    const float r = hits_[i].radius;
    const Vec3 at = hits_[i].x.surface.position;
    int size = 0;
    std::frexp(2 * r, &size);  // 2 r < 2^size
    if (std::ranges::find(sizes_, size) == sizes_.end()) sizes_.push_back(size);
    for (std::int64_t x = index_in(at.x - r, size); x <= index_in(at.x + r, size); ++x)
      for (std::int64_t y = index_in(at.y - r, size); y <= index_in(at.y + r, size); ++y)
        for (std::int64_t z = index_in(at.z - r, size); z <= index_in(at.z + r, size); ++z)
          cells_.push_back({cell_of(size, x, y, z), i});
  }
  std::ranges::sort(cells_, {}, [](const InCell& in) { return std::pair(in.cell, in.hit); });
  std::ranges::sort(sizes_);
}

/// True if a ray from the path's last event S meets the surface of `place`: a lamp may hide what lies behind it.
bool SpecularHits::sees(const HitPlace& hit, Vec3 place, Vec3 normal) const {
  const Vec3 way = place - hit.from;
  Hit met;
  if (!tracer_.intersect({hit.from, way, 0, INFINITY}, met) || std::abs(met.t - 1) > PhotonSplats::kAlong) return false;
  return std::abs(dot(tracer_.surface_point(met).position - place, normal)) <= PhotonSplats::kOff * length(way);
}

void SpecularHits::add(const formats::Photon& photon, std::optional<Vec3> wi,
                       std::vector<std::pair<std::uint32_t, double>>& to) const {
  if (photon.kind == formats::PathKind::tentative) return;
  const Vec3 place{photon.position[0], photon.position[1], photon.position[2]};
  const Vec3 normal = vec_of(formats::decode_normal(photon.normal));
  const Rgb flux = rgb_of(photon.flux);
  for (const int size : sizes_) {
    const std::uint64_t cell = cell_of(size, index_in(place.x, size), index_in(place.y, size), index_in(place.z, size));
    for (auto in = std::ranges::lower_bound(cells_, cell, {}, &InCell::cell); in != cells_.end() && in->cell == cell;
         ++in) {
      const HitPlace& hit = hits_[in->hit];
      const Vec3 off = place - hit.x.surface.position;
      if (dot(off, off) > hit.radius * hit.radius || dot(normal, hit.normal) < kSameSide ||
          std::abs(dot(off, hit.normal)) > kOffPlane * hit.radius)
        continue;
      if (!sees(hit, place, normal)) continue;
      Rgb light = hit.weight * flux;
      if (wi && photon.kind == formats::PathKind::caustic)
        light *=
            received_share(*wi, normal, {hit.x.normal_geometric, hit.x.facing(hit.smooth), hit.x.normal, &hit.x.bsdf});
      to.emplace_back(in->hit, channel_mean(Rgbd(light)));
    }
  }
}

}  // namespace tempolux
