#include "lib/light/sky_source.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/core/random.h"

namespace tempolux {
namespace {

/// pdf [1/sr] of a direction of the environment that is drawn by radiance or from a grid.
double mixed_pdf(double by_radiance, const SkyGuide::Grid& grid, Vec3 direction) {
  return kUnguidedShare * by_radiance + (1 - kUnguidedShare) * grid.pdf_solid_angle(direction);
}

}  // namespace

/// Choosing used some of the bits of u_float.x, so bits made from the other coordinate are added in their places;
/// likewise for u_float.y.
bool SkySource::sample(Vec3 point, double probability, double u, Vec2 u_float, LightSample& s) const {
  const auto more_bits = [](float other) { return 0x1p-24 * unit_double(mix64(std::bit_cast<std::uint32_t>(other))); };
  EnvironmentLight::Sample found;
  const double u1 = std::min(u + more_bits(u_float.y) / probability, 1 - 0x1p-53),
               u2 = std::min(double(u_float.y) + more_bits(u_float.x), 1 - 0x1p-53);
  if (!grid) {
    if (!map.sample(u1, u2, found)) return false;
  } else {
    if (u1 >= kUnguidedShare) found.direction = grid->sample((u1 - kUnguidedShare) / (1 - kUnguidedShare), u2);
    else if (!map.sample(u1 / kUnguidedShare, u2, found)) return false;
    const EnvironmentLight::Place place = map.place_of(found.direction);
    found.radiance = map.radiance_at(place);
    found.pdf_solid_angle = mixed_pdf(map.pdf_solid_angle(place, found.direction), *grid, found.direction);
  }
  const double pdf = found.pdf_solid_angle * probability;
  s.wi = found.direction;
  s.position = point + s.wi * aim.distance_beyond();
  s.facing_irradiance = Rgb(Rgbd(found.radiance) / pdf);
  s.pdf_solid_angle = float(pdf);
  s.distant = true;
  return s.pdf_solid_angle > 0 && s.pdf_solid_angle < INFINITY;
}

double SkySource::pdf_solid_angle(const EnvironmentLight::Place& place, Vec3 direction) const {
  const double by_radiance = map.pdf_solid_angle(place, direction);
  return grid ? mixed_pdf(by_radiance, *grid, direction) : by_radiance;
}

void SkySource::emit(double u0, const std::array<double, 4>& u, double probability, PhotonEmission& e) const {
  EnvironmentLight::Sample from;
  if (!map.sample(u0, u[1], from)) {
    e.travel = {0, -1, 0};
    e.flux = Rgb(0.0f);
    return;
  }
  e.travel = -from.direction;
  start_distant(aim, u[2], u[3], Rgbd(from.radiance) * (aim.disc_area() / from.pdf_solid_angle) / probability, e);
}

void start_distant(const Aim& aim, double u, double v, Rgbd flux, PhotonEmission& e) {
  const Aim::Start start = aim.start(e.travel, u, v);
  e.origin = start.origin;
  e.flux = Rgb(flux * start.flux);
}

}  // namespace tempolux
