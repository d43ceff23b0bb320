// lib/photon/photon_media.cpp -- traces photons through participating media.
#include <algorithm>

#include "lib/photon/photon_ledger.h"
#include "lib/photon/photon_path.h"
#include "lib/photon/pilot_signature.h"
#include "lib/photon/photon_trace.h"
#include "lib/volume/flight.h"
#include "lib/volume/phase.h"

namespace tempolux {

const MajorantGrid& PhotonTracer::majorants() const {
  static const MajorantGrid none;
  return media_ ? media_->majorants() : none;
}

/// Follows the photons of a wave to the next surface through media, as the loop of follow() does without media. Lists
/// photons that a medium scatters before they reach a surface in wave.scattered. Returns the number of photons that
/// arrive.
std::size_t PhotonTracer::fly(std::uint32_t bounce, std::size_t count, Wave& wave, std::size_t& scattered_count,
                              PhotonBatch& batch) const {
  std::size_t arrived = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Path& path = wave.paths[wave.alive[i]];
    const bool meets = tracer_.intersect(path.ray, wave.hits[arrived]);
    const Flown flown = fly_through_media(path, meets ? wave.hits[arrived].t : INFINITY, bounce, batch);
    if (flown == Flown::scattered) wave.scattered[scattered_count++] = wave.alive[i];
    if (flown != Flown::through) continue;
    if (meets) wave.alive[arrived++] = wave.alive[i];
    else path.balance->escaped += Rgbd(path.flux);
  }
  return arrived;
}

PhotonTracer::Flown PhotonTracer::fly_through_media(Path& path, float end, std::uint32_t bounce,
                                                    PhotonBatch& batch) const {
  const PathRandom& random = path.random;
  Flight flight(media_->majorants(), path.ray.origin, path.ray.direction, end);
  Tentative t;
  // Direct light is recorded only on request, since volume-compose samples the lights.
  const bool records = options_.store_volume && (options_.store_direct || path.diffuse_seen || path.specular_seen);
  for (std::uint32_t step = 0;; ++step) {
    const std::uint64_t bits = random.bits(bounce, Purpose::flight, step & 0xffffff);
    const FlightNumbers numbers(bits);
    if (!flight.next(numbers.depth, t)) return Flown::through;
    ++batch.medium_steps;
    const Vec3 position = path.ray.origin + path.ray.direction * t.distance;
    Rgb flux = path.flux;
    if (path.inside.any()) flux *= path.inside.transmittance_over(tracer_.frame().materials, t.distance);
    const float extinction = media_->extinction(position);
    if (path.pilot) [[unlikely]]  // FlightNumbers does not use the last bit
      pilot_signature::look(*path.pilot, bits & 1, flux, extinction, t.majorant);
    if (records && random.get1(bounce, Purpose::medium, (step & 0x7fffff) << 1 | 1) < options_.volume_share) {
      const Rgb stored = flux * (1 / (t.majorant * options_.volume_share));
      batch.block.photons.push_back({.position = array_of(position),
                                     .flux = array_of(stored),
                                     .normal = encode_likelihood(extinction, t.majorant),
                                     .kind = formats::PathKind::tentative,
                                     .bounce = std::uint8_t(std::min(bounce, 255u))});
      if (stores_directions()) record_direction(-path.ray.direction, batch);
    }
    if (!(numbers.accept * t.majorant < extinction)) continue;

    if (path.pilot) [[unlikely]]
      pilot_signature::collide(*path.pilot, bounce, step);
    const MediumOptions& medium = media_->collided(position, random.get1(bounce, Purpose::medium)).options();
    const Rgb scattered = flux * medium.albedo;
    const float survival =
        std::min(kLargestSurvivalInMedia, max_component(scattered) / std::max(max_component(flux), 1e-37f));
    const bool wanted = !options_.first_event_smooth || path.diffuse_seen || path.specular_seen;
    const bool survives = wanted && random.get1(bounce, Purpose::roulette) < survival;
    const Rgb left = scattered * (survives ? 1 / survival : 0);
    path.balance->absorbed += Rgbd(path.flux) - Rgbd(left);
    path.flux = left;
    if (!survives) return Flown::ended;
    path.diffuse_seen = true;
    path.ray = {position, sample_hg(medium.g, path.ray.direction, random.get2(bounce, Purpose::phase)), 0, INFINITY};
    return Flown::scattered;
  }
}

}  // namespace tempolux
