// lib/light/photon_emission.cpp -- emits photons from the emission table.
#include <sstream>

#include "formats/error.h"
#include "lib/core/check.h"
#include "lib/light/lights.h"

namespace tempolux {
namespace {

[[noreturn]] void refuse_flux(const Scene* scene, double flux) {
  std::ostringstream text;
  text << (scene ? scene->path + ": " : "") << "a light of " << flux
       << " W is stronger than a photon's flux can be, 3.4e38 W; make the scene smaller or its lights weaker";
  throw InputError(text.str());
}

}  // namespace

/// The first slot whose part of [0, 1) ends above u. Rounding may make the parts end a little below 1; then the last
/// slot with a probability above 0.
std::size_t Lights::slot_at(double u) const {
  auto slot = std::size_t(std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u) - cumulative_.begin());
  while (slot > 0 && !(slots_[slot].probability > 0)) --slot;
  return slot;
}

/// The two numbers for the direction of a photon. On a two-sided triangle u[2] below 1/2 means the front, else the
/// back, and each half is stretched to [0, 1). The floor of 2 u[2], which is 1 for the back, avoids an unpredictable
/// branch.
Vec2 Lights::direction_numbers(std::size_t slot, const std::array<double, 4>& u) const {
  const bool halves = slot < triangles_.size() && triangles_[slot].two_sided;
  return {to_float(halves ? 2 * u[2] - std::floor(2 * u[2]) : u[2]), to_float(u[3])};
}

/// A part whose emission varies emits by its radiance at the start.
void Lights::emit_triangle(std::size_t slot, double u0, const std::array<double, 4>& u, Vec3 direction,
                           PhotonEmission& e) const {
  const TriangleLight& t = triangles_[slot];
  const auto [b1, b2] = t.emit(u0, u, direction, e);
  if (!t.varies) return;
  TriangleLight here = t;
  here.radiance = emitted_at(slot, b1, b2);
  e.flux = Rgb(here.flux() / slots_[slot].probability);
}

void Lights::emit(std::span<const std::array<double, 4>> u, std::span<PhotonEmission> photons) const {
  TEMPOLUX_CHECK(!slots_.empty() && u.size() == photons.size() && u.size() <= kMostEmitted);
  Vec2 numbers[kMostEmitted];
  Vec3 directions[kMostEmitted];
  for (std::size_t i = 0; i < u.size(); ++i) {
    photons[i] = {};
    photons[i].slot = std::uint32_t(slot_at(u[i][0]));
    numbers[i] = direction_numbers(photons[i].slot, u[i]);
  }
  sample_hemisphere_cos({numbers, u.size()}, directions);
  for (std::size_t i = 0; i < u.size(); ++i) {
    PhotonEmission& e = photons[i];
    const std::size_t slot = e.slot;
    const double below = slot > 0 ? cumulative_[slot - 1] : 0;
    const double u0 = stretch(u[i][0], below, slots_[slot].probability);
    e.flux = photon_flux_[slot];
    with(slot, [&](const auto& light) {
      if constexpr (requires { light.emit(u0, u[i], slots_[slot].probability, e); })
        light.emit(u0, u[i], slots_[slot].probability, e);
      else emit_triangle(slot, u0, u[i], directions[i], e);
    });
    if (!is_finite(e.flux)) refuse_flux(frame_->scene, max_component(slot_flux(slot)));
  }
}

}  // namespace tempolux
