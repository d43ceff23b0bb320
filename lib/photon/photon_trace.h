// lib/photon/photon_trace.h -- emits photons, traces them and records where they arrive.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/paths/paths.h"
#include "formats/photons/photons.h"
#include "lib/core/halton.h"
#include "lib/core/random.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/mover_watch.h"
#include "lib/trace/trace.h"
#include "lib/volume/medium.h"

namespace tempolux {

struct PhotonOptions {
  std::uint64_t seed = 0;
  std::uint64_t photon_count = 1'000'000;  ///< paths to start; rounded up to a multiple of group_count
  std::uint32_t group_count = 0;           ///< N_g, number of groups; 0: automatic
  bool store_direct = true, store_caustic = true, store_indirect = true;
  /// True to record tentative collisions in media; direct light only if store_direct is set. Each collision is kept
  /// with probability volume_share, and its flux is divided by volume_share. With ten collisions per crossing, 0.4
  /// keeps four, which is what a radiance volume can resolve (docs/methods/volume_photons.md).
  bool store_volume = false;
  float volume_share = 0.4f;
  std::uint32_t pilots = 0;  ///< number of first paths in each group that are pilots: what they meet is recorded

  /// A list of kinds from "direct,caustic,indirect,volume". Throws InputError.
  void set_kinds(const std::string& list);
  std::string kinds() const;
};

/// The largest N_g of 630 = 2 3^2 5 7, 210, 30, 6, 1 with at least 256 photons per group. With media, whose groups are
/// traced again one by one, from 2520 = 2^3 3^2 5 7 on and with at least 64 photons (a wave) per group.
std::uint32_t automatic_group_count(std::uint64_t photon_count, bool media);

/// Balance of flux, W: emitted = escaped + absorbed, up to rounding.
struct FluxBalance {
  Rgbd emitted{0.0}, escaped{0.0}, absorbed{0.0};

  FluxBalance& operator+=(const FluxBalance& o) {
    emitted += o.emitted, escaped += o.escaped, absorbed += o.absorbed;
    return *this;
  }
  FluxBalance operator-(const FluxBalance& o) const {
    return {emitted - o.emitted, escaped - o.escaped, absorbed - o.absorbed};
  }
};

/// Result of tracing a batch of photon paths.
struct PhotonBatch : FluxBalance {  ///< sums over all paths; with by_path see balance_of
  formats::PhotonBlock block;       ///< of one group
  std::uint64_t medium_steps = 0;   ///< tentative collisions
  std::uint64_t ray_count = 0, path_count = 0;
  std::uint64_t specular_ray_count = 0;       ///< rays after an event S
  std::uint64_t seen_count = 0;               ///< photons stored inside the spheres of Lights::aim()
  std::vector<formats::PhotonPilot> pilots;   ///< of the group, if its first path is in the batch
  std::vector<formats::TouchedPath> touched;  ///< if movers are watched: the paths they can touch, in order
  bool by_path = false;  ///< set to fill the members below, by the path's place in the list given to trace_paths
  std::vector<std::uint32_t> path_of;   ///< of each photon
  std::vector<FluxBalance> balance_of;  ///< of each path
  std::vector<std::uint8_t> moved;      ///< by path: true if it met a mover, or its light moves or changes
};

/// Traces photons through one frame. Photon i starts at point i of a scrambled Halton sequence and draws all else from
/// random numbers keyed by (seed, i, bounce). So it does not depend on the number of photons (except for its flux,
/// emission / probability / N), on the number of groups, or on other photons.
///
/// A photon is recorded at every surface with a Lambert lobe, before it is scattered, with
///     flux x arrival_weight(wi) x |wi.n_s| / |wi.n_g|     [W]
/// so that  rho/pi x density  is the radiance that the Lambert lobe reflects, with shading normals [Veach 1997, 5.3].
/// (Where the shading normal faces away from the eye, the eye uses the geometric normal, and photons are scattered
/// accordingly.) For a matte flat surface this is the arriving flux. n_s of a normal map is the normal at its finest
/// level, which gather rays use, too (RayCone).
///
/// A pixel looks up caustic photons itself, and its normal is the mean of the normal map over the pixel's footprint. So
/// where directions are stored (stores_directions) a caustic photon carries flux x |wi.n_v| / |wi.n_g|, where n_v is
/// the normal without the map, and the reader applies the map and the coat (received_share). Inside glass the flux is
/// divided by the squared index of refraction (bsdf.h). Light that solids absorb counts as absorbed. On a surface of
/// alpha mode BLEND only a share alpha of the photons is recorded, with the flux divided by alpha. Russian roulette
/// keeps the flux of a path about constant without bias.
///
/// In media (SceneFrame::media) a photon flies by null collisions under the media's majorants, raised to ten tentative
/// collisions per mean crossing of their box; random numbers are keyed by (seed, i, bounce, step). At each tentative
/// collision, real or null, a photon of kind tentative may be recorded with
///     flux / (majorant x volume_share)     [W m]
/// so that the sum over a region is the integral of fluence over it, whatever the density there. A real collision
/// scatters the albedo's share by the phase function, with roulette as at surfaces.
class PhotonTracer {
 public:
  PhotonTracer(const Tracer& tracer, const Lights& lights, const PhotonOptions& options);

  std::uint64_t photon_count() const { return group_count_ * members_; }
  std::uint32_t group_count() const { return std::uint32_t(group_count_); }
  /// Batches are in file order: group after group, each cut into pieces of kBatch paths. The photons of a path follow
  /// each other by ascending bounce. With media the photons of a batch are sorted by waves of kWave paths, and within a
  /// wave by bounce.
  std::size_t batch_count() const { return std::size_t(group_count_) * batches_per_group_; }
  /// First batch of a group, and the first batch after the group.
  std::pair<std::size_t, std::size_t> batches_of(std::uint32_t group) const {
    return {std::size_t(group * batches_per_group_), std::size_t((group + 1) * batches_per_group_)};
  }
  /// The frame's media with raised majorants, or null.
  const Media* media() const { return media_ ? &*media_ : nullptr; }
  /// The majorants in use, with the lower bound; empty without media.
  const MajorantGrid& majorants() const;
  /// True if photons store their direction. They do if a phase function is anisotropic, or if caustic light may fall
  /// on normal maps.
  bool stores_directions() const { return directions_; }
  /// Traces batch number b < batch_count(). Thread-safe.
  PhotonBatch trace(std::size_t batch) const;
  /// Traces paths first .. last - 1 of a group, also paths that the map does not have (last > photon_count() /
  /// group_count()), with the flux of the map's own paths. Thread-safe.
  PhotonBatch trace_members(std::uint32_t group, std::uint64_t first, std::uint64_t last) const;
  /// Number of paths of each group.
  std::uint64_t members() const { return members_; }
  std::uint64_t seed() const { return options_.seed; }
  const PhotonOptions& options() const { return options_; }
  /// Traces these paths, which must be of one group. Thread-safe.
  PhotonBatch trace_paths(std::span<const std::uint64_t> paths) const;

  /// From now on trace() finds the paths that movers can touch: a ray of the path meets a box of `watch`, or its light
  /// moves or changes. `watch` must outlive this object; nullptr: none.
  void watch(const MoverWatch* watch);

  /// Paths of a batch, a block of 40 kB in the file: batches in flight fit into the processor's cache, and memory does
  /// not grow with the number of photons.
  static constexpr std::uint64_t kBatch = 1024;

 private:
  struct Path;
  struct Wave;
  struct Draw;
  struct Meeting;
  /// Photons followed together; their state fits into the first-level cache.
  static constexpr std::uint64_t kWave = 64;
  static_assert(kWave <= Lights::kMostEmitted);

  /// Follows the photons of these numbers to their ends; at most kWave. first_path is the place of the first one in the
  /// caller's list.
  void follow(std::span<const std::uint64_t> numbers, std::uint32_t first_path, PhotonBatch& batch) const;
  std::size_t start(std::span<const std::uint64_t> numbers, std::uint32_t first_path, Wave& wave,
                    PhotonBatch& batch) const;
  std::size_t leave_planes_of_lights(std::size_t arrived, Wave& wave, PhotonBatch& batch) const;
  bool moves(const Hit& hit) const { return hit.surface >= tracer_.frame().static_count; }
  std::size_t fly(std::uint32_t bounce, std::size_t count, Wave& wave, std::size_t& scattered_count,
                  PhotonBatch& batch) const;
  enum class Flown { through, scattered, ended };
  Flown fly_through_media(Path& path, float end, std::uint32_t bounce, PhotonBatch& batch) const;
  bool scatter(Path& path, SurfacePoint& point, float distance, const Draw& draw, PhotonBatch& batch) const;
  float aim(Vec3 position, Vec3 normal, const PathRandom& random, std::uint32_t bounce, Vec3& travel) const;
  void store(const Path& path, const Meeting& at, Rgb flux, std::uint32_t bounce, PhotonBatch& batch) const;
  bool scatter_at(Path& path, const Meeting& at, const Draw& draw, PhotonBatch& batch) const;

  const Tracer& tracer_;
  const Lights& lights_;
  PhotonOptions options_;
  PhotonHalton halton_;
  std::array<bool, 3> stores_{};   ///< by formats::PathKind
  bool has_point_lights_ = false;  ///< or spots
  bool directions_ = false;
  std::optional<Media> media_;              ///< the frame's media, with raised majorants
  std::vector<char> solid_;                 ///< by material: true for the boundary of solid glass
  std::vector<std::array<Bsdf, 2>> bsdfs_;  ///< by material: for light from the back, from the front
  std::vector<std::uint8_t> varies_;        ///< by material: true if textures vary it over the surface
  std::uint64_t group_count_, members_, batches_per_group_;
  const MoverWatch* watch_ = nullptr;
  std::vector<char> slot_moves_;  ///< by slot of the emission table: true if the light moves or changes
};

}  // namespace tempolux
