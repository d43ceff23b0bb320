#include "lib/render/photon_light.h"

#include <array>
#include <cmath>

#include "lib/density/photon_reach.h"
#include "lib/points/point_density.h"

namespace tempolux {
namespace {

constexpr std::size_t kRemembered = 4;  ///< number of places in each half of a pixel: it may see several surfaces
constexpr float kAlike = 0.999f;        ///< least cosine between normals at places that share caustic light

/// Caustic irradiance that was estimated at a place.
struct Remembered {
  const PhotonLight* of = nullptr;
  Vec3 position, geometric, shading;
  float let_in = 1;      ///< Bsdf::arrival_weight of light along the normal
  FootprintLight light;  ///< reused within light.alike_within

  static float let_in_by(const LitSurface& surface) {
    return surface.bsdf ? surface.bsdf->arrival_weight(Vec3{0, 0, 1}) : 1;
  }
  bool holds_at(const PhotonLight* map, Vec3 place, const LitSurface& surface) const {
    return of == map && length2(place - position) < light.alike_within * light.alike_within &&
           dot(surface.geometric, geometric) > kAlike && dot(surface.shading, shading) > kAlike &&
           let_in_by(surface) == let_in;
  }
};

/// Places that a thread remembers, for each half of a pixel's samples.
struct Memory {
  bool used = false;
  std::size_t half = 0;
  std::array<std::array<Remembered, kRemembered>, 2> places{};
  std::array<std::size_t, 2> next{};
};
thread_local Memory memory;

}  // namespace

CausticMemory::CausticMemory() { memory = {.used = true}; }
CausticMemory::~CausticMemory() { memory.used = false; }
void CausticMemory::use_half(int half) { memory.half = std::size_t(half); }

PhotonLight::PhotonLight(const Tracer& tracer, const PhotonView& photons, Vec3d photon_shift,
                         const PhotonLightOptions& options) {
  options_.neighbours = options.neighbours;
  has_indirect_ = !options.caustic_only;
  if (has_indirect_) indirect_ = PhotonIndex(photons.photons, kind_bit(formats::PathKind::indirect), photon_shift);
  if (indirect_.size() > 0) options_.max_radius = PointDensity::kSparser * photon_reach(indirect_, options.neighbours);
  const FootprintOptions density{.neighbours = options.caustic_neighbours, .asked = kAskedPhotons};
  caustic_ =
      std::make_unique<FootprintDensity>(tracer, photons, density, kind_bit(formats::PathKind::caustic), photon_shift);
  if (caustic_->empty()) caustic_.reset();
}

FootprintLight PhotonLight::caustic(Vec3 position, const LitSurface& surface) const {
  if (!caustic_) return {};
  if (!memory.used) return caustic_->estimate(position, surface);
  auto& places = memory.places[memory.half];
  for (const Remembered& place : places)
    if (place.holds_at(this, position, surface)) return place.light;
  const FootprintLight light = caustic_->estimate(position, surface);
  if (light.alike_within > 0)
    places[memory.next[memory.half]++ % kRemembered] = {
        this, position, surface.geometric, surface.shading, Remembered::let_in_by(surface), light};
  return light;
}

Rgb PhotonLight::indirect(Vec3 position, Vec3 normal) const {
  if (indirect_.size() == 0) return Rgb(0.0f);
  thread_local NeighbourList scratch;
  return Rgb(estimate_irradiance(indirect_, position, normal, options_, scratch).irradiance);
}

}  // namespace tempolux
