// lib/light/lights.h -- all lights of a frame behind one sampling interface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lib/core/vec.h"
#include "lib/light/aim.h"
#include "lib/light/environment_light.h"
#include "lib/light/light_grid.h"
#include "lib/light/light_tree.h"
#include "lib/light/triangle_light.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// One slot of the emission table: an emissive triangle (both sides, twice the flux, if its material is
/// double sided), a punctual light, or the environment. Slots and probabilities are frozen over a segment: a lamp that
/// dims or moves keeps its slot and changes the photon's weight.
struct EmissionSlot {
  enum class Kind : std::uint8_t { triangle, point, spot, directional, environment };
  Kind kind = Kind::triangle;
  std::uint32_t surface = kNone, triangle = 0;  ///< of a triangle
  std::uint32_t light = kNone;                  ///< index into SceneFrame::lights
  double probability = 0;                       ///< of being chosen for a photon; sums to 1 over the table
};

/// What is frozen over a segment. Slots are the triangles of `surfaces`, one after the other, then the
/// frame's punctual lights, then the environment if there is one; probability is proportional to the maximum flux over
/// the segment's frames
/// (luminance, but at least 5 % of the largest channel, so that blue lamps count; a directional light's flux
/// is its irradiance times the area pi R^2 of the scene sphere's disc, the environment's pi R^2 times the integral
/// of its radiance). Most light from outside may never come in, or what is inside may hardly matter: where there
/// is an environment besides other lights, either gets at least a fifth. A triangle whose emission a
/// texture makes vary counts with its mean.
struct EmissionTable {
  std::vector<std::uint32_t> surfaces;  ///< that emit at some frame: indices into SceneFrame::surfaces
  std::vector<EmissionShares> shares;   ///< of `surfaces`, at the first frame
  std::vector<double> probability;      ///< by slot, sums to 1; equal if nothing ever emits
  Vec3d sphere_centre{};                ///< scene sphere over the segment, scene space, m
  double sphere_radius = 0;
  std::shared_ptr<const EnvironmentLight> environment;  ///< nullptr: none; its Environment must outlive it
  std::vector<AimSphere> aim;  ///< where photons of directional lights and the environment go; empty: everywhere
};

/// The triangles of table.surfaces[index] as lights of a frame, in their order.
std::vector<TriangleLight> triangle_lights(const EmissionTable& table, std::size_t index, const SceneFrame& frame);

/// The segment's table: made from all of its frames if something that emits moves, else from one.
EmissionTable build_emission_table(const Scene& scene, const Segment& segment, const TimeOptions& options);
/// The table of frames that are evaluated already, all of one segment (the same surfaces and lights in the same order);
/// at least one. To be the segment's table they must be all frames at which an emitter's size differs.
EmissionTable build_emission_table(std::span<const SceneFrame> frames);

/// Content hash of what the segment freezes beyond its static geometry: probabilities of lights, distance scales, and
/// where photons are aimed. Photons
/// whose tables hash alike may replace each other path by path.
std::string emission_hash(const EmissionTable& table, const Segment& segment);

struct LightSample {
  Vec3 wi{};                  ///< unit, from the point towards the light
  Vec3 position{};            ///< on the light; for directional lights and the environment beyond the scene
  float position_offset = 0;  ///< m: the shadow ray ends this far before position
  Rgb radiance{
      0.0f};  ///< L / pdf of an area light or the environment, I / d^2 or E of a delta light: multiply by f cos
  float pdf_solid_angle = 0;  ///< [1/sr], choice included; 0 if delta
  bool delta = false;
  bool distant = false;  ///< of the environment or a directional light
};

struct PhotonEmission {
  Vec3 origin{}, travel{};  ///< travel: unit direction of flight
  float origin_offset = 0;  ///< start this far along the emitting side's normal
  Vec3 normal{};            ///< of the emitting side; zero for punctual lights
  Rgb flux{0.0f};           ///< W, of one photon if `photon_count` are emitted: divide by the count yourself
  std::uint32_t slot = 0;
};

/// Lights at one frame.
class Lights {
 public:
  Lights(const SceneFrame& frame, const EmissionTable& table);
  ~Lights();
  Lights(Lights&&) noexcept;

  /// From now on samples are drawn by what the grid has learned of what reaches a place, where it knows the place;
  /// nullptr: no more. The grid must outlive this. Probabilities alone change: no bias.
  void use(const LightGrid* grid);
  /// From now on directions of the environment are drawn by radiance and by the cosine (SkyByNormal), where sample() is
  /// given a normal and no grid knows the place. No bias. Some milliseconds.
  void weigh_sky_by_cosine();
  /// Directional lights that shine, and the environment: is there light from far away?
  bool has_distant() const;
  /// Is there light from somewhere: a lamp that shines?
  bool has_placed() const;
  /// Irradiance of each directional light that shines, at right angles, and the direction it comes from.
  struct Sun {
    Vec3 wi;
    Rgb irradiance;
  };
  std::vector<Sun> suns() const;
  /// Which lights sample() chooses from: where a sample of the suns is taken by itself, all others.
  enum class From : std::uint8_t { all, not_suns };
  bool has_suns() const;
  /// Chooses a directional light by its irradiance; u in [0, 1). False if none is above the surface.
  bool sample_sun(Vec3 point, Vec3 normal, float u, LightSample& sample) const;

  bool empty() const;
  std::size_t count() const;
  const std::vector<EmissionSlot>& slots() const;
  /// Flux of all lights [W]; directional lights and the environment by the scene sphere's disc.
  Rgbd total_flux() const;

  /// Chooses a light for the point (u_choice; by an importance that knows distance and orientation, in
  /// O(log n)) and a point on it (u). Returns false if no light can reach the point. `normal` is a hint to
  /// discard lights below the surface; zero vector: none.
  bool sample(Vec3 point, Vec3 normal, float u_choice, Vec2 u, LightSample& sample) const;
  /// The same from one stratified pair: u.x chooses the light and, stretched, is its first coordinate on it, so
  /// that samples stratified over the square are stratified over every light.
  bool sample(Vec3 point, Vec3 normal, Vec2 u, LightSample& sample, From from = From::all) const;
  /// Density per solid angle with which sample() at (point, normal) would have chosen the position
  /// `on_light` of this emissive triangle, seen from its front or (two-sided) back; 0 if it is no light. The
  /// triangle's own plane decides, as in sample(); light_normal is not looked at.
  float pdf_solid_angle(Vec3 point, Vec3 normal, std::uint32_t surface, std::uint32_t triangle, Vec3 on_light,
                        Vec3 light_normal, From from = From::all) const;
  /// Radiance that the material emits at a hit towards `wo` (unit, away from it), textures read over `width` m; zero
  /// from the back of a one-sided emitter.
  Rgb emitted(const SurfacePoint& hit, Vec3 wo, float width) const;

  bool has_environment() const { return environment_ != nullptr; }
  /// Radiance that arrives from `direction` (unit) where nothing is in the way; only with an environment.
  Rgb environment(Vec3 direction) const { return environment_->radiance(direction); }
  /// Density per solid angle with which sample() at (point, normal) would have chosen this direction of the
  /// environment; only with one.
  float pdf_environment(Vec3 point, Vec3 normal, Vec3 direction, From from = From::all) const {
    return pdf_environment(point, normal, environment_->place_of(direction), direction, from);
  }
  /// Both of one look-up.
  EnvironmentLight::Place environment_place(Vec3 direction) const { return environment_->place_of(direction); }
  Rgb environment_at(const EnvironmentLight::Place& place) const { return environment_->radiance_at(place); }
  float pdf_environment(Vec3 point, Vec3 normal, const EnvironmentLight::Place& place, Vec3 direction, From from) const;

  /// A photon from the frozen table: u[0] chooses the slot and, stretched, is the first coordinate on it,
  /// u[1] the second; u[2], u[3] the direction (of a two-sided triangle the lower half of u[2] leaves the
  /// front). Point and spot lights have no place to choose and take u[0], u[1] for the direction, directional
  /// lights for the place on the scene sphere's disc; the environment takes them for the direction and u[2], u[3]
  /// for the place on the disc. All maps keep neighbours together. Not for an empty
  /// table.
  ///
  /// flux = (what the slot emits at this frame) / probability: the mean over u is total_flux(). Triangle: pi
  /// L A (twice if two-sided), by the cosine; point: 4 pi I, uniform; spot: as its intensity; directional: E
  /// pi R^2, origin on the disc of radius R outside the scene; environment: the same with radiance / density of
  /// the direction for E. With table.aim the origins of these two are spread as Aim says, and the flux is
  /// divided by that density instead. Zero flux for what emits nothing at this
  /// frame. InputError if flux / probability is beyond float32.
  PhotonEmission emit(const std::array<double, 4>& u) const {
    PhotonEmission photon;
    emit({&u, 1}, {&photon, 1});
    return photon;
  }
  /// The same for as many as kMostEmitted, photons[i] of u[i]: in half the time.
  void emit(std::span<const std::array<double, 4>> u, std::span<PhotonEmission> photons) const;
  static constexpr std::size_t kMostEmitted = 64;

  /// Where photons from afar are aimed; empty: everywhere.
  const Aim& aim() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  const EnvironmentLight* environment_ = nullptr;
};

}  // namespace tempolux
