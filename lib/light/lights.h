// lib/light/lights.h -- all lights of a frame behind one sampling interface.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lib/core/pi.h"
#include "lib/core/sampling.h"
#include "lib/core/vec.h"
#include "lib/light/aim.h"
#include "lib/light/environment_light.h"
#include "lib/light/light_sample.h"
#include "lib/light/light_tree.h"
#include "lib/light/punctual.h"
#include "lib/light/sky_source.h"
#include "lib/light/triangle_light.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// An entry of the emission table: an emissive triangle or a part of one, a punctual light, or the environment. A
/// triangle of a double sided material has the flux of both sides. Slots and probabilities stay the same over a
/// segment: a lamp that is dimmed or moved keeps its slot, and only the flux of its photons changes.
struct EmissionSlot {
  enum class Kind : std::uint8_t { triangle, punctual, environment };
  Kind kind = Kind::triangle;
  std::uint32_t surface = kNone, triangle = 0;  ///< index into SceneFrame::surfaces; index of the triangle in it
  std::uint32_t light = kNone;                  ///< index into SceneFrame::lights
  double probability = 0;                       ///< of choosing this slot for a photon; sums to 1 over the table
};

/// Weight of a flux [W] when photons are shared out among lights: its luminance, or 5 % of its largest channel if that
/// is more, so that blue lamps get photons, too.
double emission_weight(Rgbd flux);

/// Probabilities with which lights emit photons, the same for all frames of a segment. Slots are the parts of
/// the triangles of `surfaces` in order, then the frame's punctual lights, then the environment if there is one.
/// A probability is proportional to the slot's maximum flux (emission_weight) over the segment's frames. A directional
/// light's flux is its irradiance times the area pi R^2 of the scene sphere's disc; the environment's is pi R^2 times
/// the integral of its radiance. A part of a triangle whose emission is textured counts with its mean. Flux is a poor
/// measure between an environment and other lights: a building lets in little of the sky's light, and outdoors lamps
/// add little to the light of the sky. So if a scene has both, the environment gets at least kUnguidedShare of the
/// photons, and the other lights together get at least as much.
struct EmissionTable {
  std::vector<std::uint32_t> surfaces;  ///< indices into SceneFrame::surfaces of the surfaces that emit at some frame
  std::vector<std::shared_ptr<const EmissionParts>> parts;  ///< of `surfaces`, shares of the first frame
  std::vector<double> probability;                          ///< by slot, sums to 1; all equal if nothing ever emits
  Vec3d sphere_centre{};                                    ///< scene sphere over the segment; scene space, m
  double sphere_radius = 0;
  std::shared_ptr<const EnvironmentLight> environment;  ///< its Environment must outlive the table; nullptr: none
  std::vector<AimSphere> aim;  ///< spheres to aim photons of directional lights and environment at; empty: no aiming
  std::vector<AimSphere> openings;  ///< through which light of sun and sky reaches what is seen (Aim)
};

/// The parts table.parts[index] as lights of a frame, in the same order.
std::vector<TriangleLight> triangle_lights(const EmissionTable& table, std::size_t index, const SceneFrame& frame);

/// The segment's table. Evaluates all frames of the segment if an emitter moves, else one frame.
EmissionTable build_emission_table(const Scene& scene, const Segment& segment, const TimeOptions& options);
/// The table from frames that are evaluated already: at least one, all of one segment (the same surfaces and lights in
/// the same order). To get the segment's table, pass all frames at which an emitter's size differs.
EmissionTable build_emission_table(std::span<const SceneFrame> frames);

/// Hash of the numbers that decide where photons start, apart from the static geometry: probabilities of slots, the
/// scene sphere, the segment's origin and bounds, and aim. If two tables have the same hash, a light path of one photon
/// map may replace the path with the same number in the other map.
std::string emission_hash(const EmissionTable& table, const Segment& segment);

/// All lights of one frame: draws light samples and photons.
class Lights {
 public:
  /// The lights that shine. all: every light. placed: triangles, point lights and spot lights. distant: directional
  /// lights and the environment. punctual: point, spot and directional lights. lamps: all but the environment.
  enum class Which : std::uint8_t { all, placed, distant, punctual, lamps };
  /// Lights that do not shine keep their slots, with probability 0. At least one slot must shine if photons are
  /// emitted. `frame` must outlive this object; `table` need not.
  Lights(const SceneFrame& frame, const EmissionTable& table, Which which = Which::all);

  /// The lights inside the scene alone, for emit(). Half of the photons are shared out by the probabilities of the
  /// table, the other half equally among the nodes that hold lights. So a weak lamp gets photons beside suns and strong
  /// lamps. No light emits if nothing shines inside the scene.
  Lights placed_alike() const;

  /// The same lights with a guide. Where the guide has a grid, sample() draws a direction of the environment from the
  /// grid with probability 1 - kUnguidedShare, else by radiance. Where no sun is chosen as well, sample() chooses
  /// between the environment and the lights inside the scene by what the guide has found of both behind walls. All pdfs
  /// are those of these choices, so expected values do not change. A misleading guide multiplies the mean square of a
  /// sample by at most 4 / kUnguidedShare. emit() does not use the guide.
  Lights guided(std::shared_ptr<const SkyGuide> guide) const;
  /// nullptr: none.
  const std::shared_ptr<const SkyGuide>& guide() const { return guide_; }

  /// True if the slot holds a directional light or the environment.
  bool is_distant(std::size_t slot) const;
  /// True if a directional light shines or the environment is not black.
  bool has_distant() const { return environment_weight_ > 0 || !suns_.empty(); }
  /// True if any light inside the scene shines.
  bool has_placed() const { return !tree_.empty(); }
  /// Which lights sample() chooses from. A caller that samples directional lights by sample_sun() passes not_suns.
  enum class From : std::uint8_t { all, not_suns };
  /// True if a directional light shines.
  bool has_suns() const { return !suns_.empty(); }
  /// Chooses a directional light in proportion to its irradiance on the surface of `normal` (unit). u.x in [0, 1)
  /// chooses; the rest of u.x and u.y choose a direction of the light's disc. False if none is above the surface.
  bool sample_sun(Vec3 point, Vec3 normal, Vec2 u, LightSample& sample) const;

  /// Chooses a light inside the scene, as sample() does where nothing else shines. `unshadowed` [W/m^2]: the light
  /// tree's estimate of their irradiance without shadows. False if none can reach the point.
  bool sample_placed(Vec3 point, Vec3 normal, Vec2 u, LightSample& sample, double& unshadowed) const;

  bool empty() const { return slots_.empty(); }        ///< true if the emission table has no slot
  std::size_t count() const { return slots_.size(); }  ///< number of slots
  /// The slots of the emission table, in its order.
  const std::vector<EmissionSlot>& slots() const { return slots_; }
  /// Flux of all lights [W]. Directional lights and the environment count with the flux through the scene sphere's
  /// disc.
  Rgbd total_flux() const;

  /// Chooses a light for the point with u_choice, in O(log n), by an importance that includes distance and orientation;
  /// then a point on the light with u. All numbers are in [0, 1). False if no light can reach the point. Lights below
  /// the surface of `normal` (unit) are excluded; a zero normal excludes none.
  bool sample(Vec3 point, Vec3 normal, float u_choice, Vec2 u, LightSample& sample) const {
    return sample_any(point, normal, {u_choice, u, false}, From::all, sample);
  }
  /// The same from two numbers. u.x chooses the light; its place inside the light's part of [0, 1), stretched to
  /// [0, 1), is the first coordinate on the light. Samples that are stratified over the square are stratified over
  /// every light.
  bool sample(Vec3 point, Vec3 normal, Vec2 u, LightSample& sample, From from = From::all) const {
    return sample_any(point, normal, {u.x, u, true}, from, sample);
  }
  /// pdf [1/sr] with which sample() at (point, normal) chooses the position `on_light` of a triangle; 0 if the triangle
  /// emits nothing towards the point. The triangle's own plane decides which side is seen, as in sample().
  float pdf_solid_angle(Vec3 point, Vec3 normal, std::uint32_t surface, std::uint32_t triangle, Vec3 on_light,
                        From from = From::all) const;
  /// Radiance [W/m^2/sr] that the material emits at a hit towards `wo` (unit, away from the surface). Textures are
  /// averaged over `width` m. Zero from the back of a one-sided emitter.
  Rgb emitted(const SurfacePoint& hit, Vec3 wo, float width) const;

  /// True if the environment shines and is not black. The next four functions need an environment.
  bool has_environment() const { return environment_weight_ > 0; }
  /// Radiance [W/m^2/sr] that arrives from `direction` (unit, towards the environment).
  Rgb environment(Vec3 direction) const { return environment_->radiance(direction); }
  /// The place of a direction in the map, for the next two functions.
  EnvironmentLight::Place environment_place(Vec3 direction) const { return environment_->place_of(direction); }
  /// Radiance [W/m^2/sr] of the environment at a place.
  Rgb environment_at(const EnvironmentLight::Place& place) const { return environment_->radiance_at(place); }
  /// pdf [1/sr] with which sample() at (point, normal) chooses `direction` (unit), whose place is `place`.
  float pdf_environment(Vec3 point, Vec3 normal, const EnvironmentLight::Place& place, Vec3 direction, From from) const;

  /// Emits a photon from four numbers in [0, 1); neighbouring numbers give neighbouring photons. u[0] chooses the slot.
  /// Its place inside the slot's part of [0, 1), stretched to [0, 1), replaces u[0] below.
  /// Triangle: u[0] and u[1] give the point, u[2] and u[3] the direction; if two-sided, u[2] below 1/2 means the front.
  /// Point or spot light: u[0] and u[1] give the direction, u[2] and u[3] the place on its sphere. Directional light:
  /// u[0] and u[1] give the point on the scene sphere's disc, u[2] and u[3] the direction in the light's own disc.
  /// Environment: u[0] and u[1] give the direction, u[2] and u[3] the point on the scene sphere's disc.
  /// The table must not be empty.
  ///
  /// flux = (flux of the slot at this frame) / probability, so the mean over u is total_flux(). A triangle's flux is
  /// pi L A, twice as much if two-sided, and its directions have the pdf cos / pi. A point light's flux is 4 pi I, with
  /// uniform directions; a spot's directions are drawn by intensity. A directional light's flux is E pi R^2, times
  /// 2 / (1 + cos a) if half its angular diameter is a, from the disc of the scene sphere's radius R; the environment's
  /// is the same with radiance / pdf in place of E. With table.aim the start points of the last two are drawn by Aim,
  /// and flux is multiplied by Aim::Start::flux. Flux is zero if the slot emits nothing at this frame. Throws
  /// InputError if flux / probability overflows float32.
  PhotonEmission emit(const std::array<double, 4>& u) const {
    PhotonEmission photon;
    emit({&u, 1}, {&photon, 1});
    return photon;
  }
  /// The same for up to kMostEmitted photons, photons[i] from u[i]; twice as fast per photon.
  void emit(std::span<const std::array<double, 4>> u, std::span<PhotonEmission> photons) const;
  static constexpr std::size_t kMostEmitted = 64;

  /// The aim of photons from directional lights and environment; empty: none.
  const Aim& aim() const { return aim_; }

 private:
  /// Random numbers of a light sample. joint: `choice` is u.x, so the remainder of the choice replaces u.x.
  struct Draw {
    float choice;
    Vec2 u;
    bool joint;
  };
  /// Both forms of sample().
  bool sample_any(Vec3 point, Vec3 normal, const Draw& draw, From from, LightSample& sample) const;
  bool sample_tree(const LightTree::Start& start, double probability, Vec3 point, Vec3 normal, const Draw& draw,
                   LightSample& sample) const;
  bool sample_slot(std::uint32_t slot, Vec3 point, double probability, double left, const Draw& draw,
                   LightSample& sample) const;
  /// The distant lights at a place.
  struct Distant {
    double sky = 0, suns = 0;              ///< irradiances [W/m^2] by which sample() chooses
    double lamps = 1;                      ///< arriving part of the light tree's irradiance (SkyGuide::Part::lamps)
    const SkyGuide::Grid* grid = nullptr;  ///< of the sky's directions; null: none
    double all() const { return sky + suns; }
    /// Probability of choosing a distant light. `tree`: the light tree's irradiance at the place.
    double share(double tree) const;
  };
  Distant distant_at(Vec3 point, Vec3 normal, From from) const;
  bool sample_distant(Vec3 point, Vec3 normal, Vec2 u_float, double share, const Distant& distant,
                      LightSample& s) const;
  SkySource sky(const SkyGuide::Grid* grid) const { return {*environment_, aim_, grid}; }
  bool sample_sun(Vec3 point, Vec3 normal, double u, float u_disc, double probability, LightSample& s) const;
  bool shines(std::size_t slot) const;
  /// Calls f with the light of a slot: a TriangleLight, a PunctualSource or a SkySource.
  template <class F>
  decltype(auto) with(std::size_t slot, const F& f) const {
    if (slot < triangles_.size()) return f(triangles_[slot]);
    if (slots_[slot].kind == EmissionSlot::Kind::environment) return f(SkySource{*environment_, aim_});
    return f(PunctualSource{frame_->lights[slots_[slot].light], aim_});
  }
  void add_slots(const EmissionTable& table);
  void set_probabilities(const std::vector<double>& probability);
  void build_tree();
  std::vector<LightBounds> tree_bounds() const;
  Rgbd slot_flux(std::size_t slot) const;  ///< W
  /// Radiance of a point on a slot's triangle, by barycentric coordinates.
  Rgb emitted_at(std::size_t slot, double b1, double b2) const {
    return triangles_[slot].emitted_at(*frame_, slots_[slot].surface, slots_[slot].triangle, b1, b2);
  }
  std::size_t slot_at(double u) const;
  std::uint32_t slot_at(std::uint32_t surface, std::uint32_t triangle, Vec3 on_light) const;
  Vec2 direction_numbers(std::size_t slot, const std::array<double, 4>& u) const;
  void emit_triangle(std::size_t slot, double u0, const std::array<double, 4>& u, Vec3 direction,
                     PhotonEmission& e) const;
  /// Maps u from the part [first, first + width) of [0, 1) to [0, 1).
  static double stretch(double u, double first, double width) {
    return std::clamp((u - first) / width, 0.0, 1 - 0x1p-53);
  }
  static float to_float(double u) { return std::min(float(u), kOneMinusEpsilon); }

  const SceneFrame* frame_;
  Which which_;
  std::vector<EmissionSlot> slots_;
  std::vector<TriangleLight> triangles_;  ///< of the first slots, in the same order
  std::vector<double> cumulative_;        ///< cumulative probability, by slot
  std::vector<Rgb> photon_flux_;          ///< by slot: flux / probability, if all its photons carry the same flux
  std::vector<std::shared_ptr<const EmissionParts>> parts_;  ///< by surface; nullptr: the surface emits nothing
  std::vector<std::uint32_t> first_slot_;  ///< first slot of each surface; kNone: the surface emits nothing
  std::vector<std::uint32_t> tree_index_;  ///< by slot: number of its light in the tree; kNone: it emits nothing
  std::vector<std::uint32_t> tree_slot_;   ///< slot of each light in the tree
  std::vector<std::uint32_t> suns_;        ///< indices of the directional lights that shine
  std::shared_ptr<const EnvironmentLight> environment_;
  std::shared_ptr<const SkyGuide> guide_;  ///< nullptr: none
  double environment_weight_ = 0;  ///< irradiance from the environment, averaged over all normals; 0: none shines
  Aim aim_;  ///< where photons of directional lights and environment start; also holds the radius of the scene sphere
  LightTree tree_{{}};
};

}  // namespace tempolux
