// lib/photon/leave_lamps.cpp -- the first rays of photons: out of the sphere of a lamp, and past surfaces whose plane
// holds the lamp.
#include <cmath>

#include "lib/photon/photon_path.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {
namespace {

/// A light lies in a surface's plane if its distance from the plane is at most this multiple of the offset of rays that
/// leave the surface (a few float steps).
constexpr float kInPlane = 0.25f;
constexpr int kMostPlanes = 8;  ///< largest number of coincident surfaces that contain a point light

}  // namespace

/// Sends a path on along a ray from the place at which its photon arrived. False if the ray meets nothing; else hit and
/// point number i of the wave are the new ones.
bool PhotonTracer::fly_on(std::size_t i, const Ray& ray, Wave& wave, PhotonBatch& batch) const {
  const std::uint32_t number = wave.alive[i];
  Path& path = wave.paths[number];
  Hit& hit = wave.hits[i];
  path.ray = ray;
  ++batch.ray_count;
  const bool meets = tracer_.intersect(path.ray, hit);
  if (watch_) wave.touched[number] |= watch_->touching(path.ray, meets ? hit.t : INFINITY);
  if (meets && wave.moved) wave.moved[number] |= std::uint8_t(moves(hit));
  if (meets) wave.points[i] = tracer_.surface_point(hit);
  else path.balance->escaped += Rgbd(path.flux);
  return meets;
}

/// Calls arrives(i) for each photon of the wave. Drops the photons for which it returns false, and returns the number
/// of the others, which keep their order.
template <class Arrives>
std::size_t PhotonTracer::keep_arrived(std::size_t arrived, Wave& wave, const Arrives& arrives) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < arrived; ++i) {
    if (!arrives(i)) continue;
    wave.alive[kept] = wave.alive[i];
    wave.hits[kept] = wave.hits[i];
    wave.points[kept++] = wave.points[i];
  }
  return kept;
}

/// Photons of a lamp that is a sphere start at its far side and cross it. A photon that meets a surface inside of the
/// sphere stands for two: the photon that lights this surface, and the photon that the lamp sends outwards
/// (PhotonEmission::chord). It becomes one of the two by chance, with twice the flux. The other photons left the sphere
/// undisturbed, as if they started on its near side. Returns the number of photons that still arrive. Light that glass
/// inside of the sphere lets out comes on top of the lamp's light. In media photons start on the near side, so that
/// they collide outside of the sphere alone, and surfaces inside are not lit.
std::size_t PhotonTracer::leave_spheres_of_lamps(std::size_t arrived, Wave& wave, PhotonBatch& batch) const {
  return keep_arrived(arrived, wave, [&](std::size_t i) {
    const PhotonEmission& e = wave.emissions[wave.alive[i]];
    Path& path = wave.paths[wave.alive[i]];
    if (wave.hits[i].t >= e.chord) {
      wave.hits[i].t -= e.chord;
      return true;
    }
    path.balance->emitted += Rgbd(path.flux);
    path.flux *= 2;
    return path.random.get1(0, Purpose::light_choice) >= 0.5f ||
           fly_on(i, {e.origin, e.travel, 0, INFINITY}, wave, batch);
  });
}

/// Lets photons pass surfaces whose plane contains their point light. Such a surface receives nothing, because the
/// cosine is 0 (light samples give 0, too). Without this function rounding would start half of the photons behind the
/// plane, and they would bring half of the light's flux to one place. Returns the number of photons that still arrive.
std::size_t PhotonTracer::leave_planes_of_lights(std::size_t arrived, Wave& wave, PhotonBatch& batch) const {
  return keep_arrived(arrived, wave, [&](std::size_t i) {
    const PhotonEmission& e = wave.emissions[wave.alive[i]];
    const Path& path = wave.paths[wave.alive[i]];
    const auto in_plane = [&](const SurfacePoint& point) {
      return e.normal == Vec3{} &&
             std::abs(dot(point.position - e.origin, point.normal_geometric)) <= kInPlane * point.offset;
    };
    bool meets = true;
    for (int plane = 0; meets && plane < kMostPlanes && in_plane(wave.points[i]); ++plane)
      meets = fly_on(i, spawn_ray(wave.points[i], path.ray.direction), wave, batch);
    return meets;
  });
}

}  // namespace tempolux
