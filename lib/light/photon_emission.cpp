// lib/light/photon_emission.cpp -- emits photons from the emission table.
#include <sstream>

#include "formats/error.h"
#include "lib/core/check.h"
#include "lib/core/frame.h"
#include "lib/light/lights.h"
#include "lib/light/punctual.h"

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

/// `u0` is u[0], stretched. `direction` is relative to the emitting side's normal.
void Lights::emit_triangle(std::size_t slot, double u0, const std::array<double, 4>& u, Vec3 direction,
                           PhotonEmission& e) const {
  const TriangleLight& t = triangles_[slot];
  // Heitz' map from the square to the triangle, as in sample_triangle, in double precision.
  const double half = 0.5 * std::min(u0, u[1]), b1 = u0 - half, b2 = u[1] - half;
  const double side = t.two_sided ? 1 - 2 * std::floor(2 * u[2]) : 1;
  e.origin = t.point(b1, b2);
  e.normal = t.normal * float(side);
  e.origin_offset = t.offset;
  e.travel = t.area > 0 ? Frame(e.normal).to_world(direction) : Vec3{0, 0, 1};
  if (!t.varies) return;
  TriangleLight here = t;
  here.radiance = emitted_at(slot, b1, b2);
  e.flux = Rgb(here.flux() / slots_[slot].probability);
}

void Lights::emit_punctual(const PlacedLight& placed, double u0, const std::array<double, 4>& u,
                           PhotonEmission& e) const {
  if (placed.light.kind != PunctualLight::Kind::directional) {
    // A point light has no extent, so the first two numbers give the direction.
    e.origin = placed.position;
    e.travel = sample_punctual_direction(placed, u0, u[1]);
    return;
  }
  e.travel = placed.direction;
  start_distant(u0, u[1], Rgbd(e.flux), e);
}

/// Sets the start and flux of distant light along e.travel. `flux` is that of a photon with a uniform start on the
/// scene sphere's disc.
void Lights::start_distant(double u, double v, Rgbd flux, PhotonEmission& e) const {
  if (aim_.empty()) {
    const Vec2 disc = sample_disc_concentric({to_float(u), to_float(v)});
    const float r = float(sphere_radius_);
    e.origin = sphere_centre_ + Frame(e.travel).to_world({disc.x * r, disc.y * r, -r});
  } else {
    const Aim::Start start = aim_.start(e.travel, u, v);
    e.origin = start.origin;
    flux = flux * start.flux;
  }
  e.flux = Rgb(flux);
}

void Lights::emit_environment(std::size_t slot, double u0, const std::array<double, 4>& u, PhotonEmission& e) const {
  EnvironmentLight::Sample from;
  if (!environment_->sample(u0, u[1], from)) {
    e.travel = {0, -1, 0};
    e.flux = Rgb(0.0f);
    return;
  }
  e.travel = -from.direction;
  start_distant(u[2], u[3], Rgbd(from.radiance) * (disc_area() / from.pdf_solid_angle) / slots_[slot].probability, e);
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
    if (slot < triangles_.size()) emit_triangle(slot, u0, u[i], directions[i], e);
    else if (slots_[slot].kind == EmissionSlot::Kind::environment) emit_environment(slot, u0, u[i], e);
    else emit_punctual(frame_->lights[slots_[slot].light], u0, u[i], e);
    if (!is_finite(e.flux)) refuse_flux(frame_->scene, max_component(slot_flux(slot)));
  }
}

}  // namespace tempolux
