// lib/photon/photon_trace.h -- emit photons, follow them, record where they arrive.
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
  std::uint32_t group_count = 0;           ///< N_g; 0: automatic
  bool store_direct = true, store_caustic = true, store_indirect = true;
  /// Tentative collisions in media, those of direct light only with store_direct. Of each so many are kept at random,
  /// as much heavier: of ten to a crossing four, which is what a radiance volume can resolve
  /// (docs/methods/volume_photons.md).
  bool store_volume = false;
  float volume_share = 0.4f;
  std::uint32_t pilots = 0;  ///< so many of each group's first paths are pilots: what they met is taken down

  /// "direct,caustic,indirect,volume" or a part of it. Throws InputError.
  void set_kinds(const std::string& list);
  std::string kinds() const;
};

/// N_g that keeps groups at 256 photons or more: the largest of 630 = 2 3^2 5 7, 210, 30, 6, 1 that does. With media,
/// where groups are shot again one by one, at 64 photons, a wave, or more, and from 2520 = 2^3 3^2 5 7 down.
std::uint32_t automatic_group_count(std::uint64_t photon_count, bool media);

/// Where flux came from and went, W: emitted = escaped + absorbed up to rounding.
struct FluxBalance {
  Rgbd emitted{0.0}, escaped{0.0}, absorbed{0.0};
};

/// What a batch of photon paths left behind.
struct PhotonBatch : FluxBalance {  ///< of all paths; if by_path see balance_of
  formats::PhotonBlock block;       ///< of one group
  std::uint64_t medium_steps = 0;   ///< tentative collisions
  std::uint64_t ray_count = 0, path_count = 0;
  std::uint64_t specular_ray_count = 0;       ///< of the rays: those that an event S sent
  std::uint64_t seen_count = 0;               ///< photons stored in the spheres of Lights::aim()
  std::vector<formats::PhotonPilot> pilots;   ///< of the group, if its first path is in the batch
  std::vector<formats::TouchedPath> touched;  ///< if movers are watched: those that they can touch, in order
  bool by_path = false;                       ///< fill in, by number of the path in the list given to trace_paths:
  std::vector<std::uint32_t> path_of;         ///< of each photon
  std::vector<FluxBalance> balance_of;        ///< of each path
  std::vector<std::uint8_t> moved;            ///< of each path: it met something that moves, or its light does
};

/// Traces photons through one frame. Photon i starts at point i of a scrambled Halton sequence and draws all
/// else from random numbers keyed by (seed, i, bounce): it does not depend on the number of photons (but for
/// its flux, emission / probability / N), on the group count or on any other photon.
///
/// A photon is recorded at every surface that has a Lambert lobe, before it is scattered, with
///     flux x arrival_weight(wi) x |wi.n_s| / |wi.n_g|     [W]
/// so that  rho/pi x density  is what the Lambert lobe reflects, shading normals included [Veach 1997, 5.3]
/// (they scatter to where the eye looks from: by the geometric normal, too, where the shading normal looks away);
/// for a matte flat surface that is the flux that arrives. n_s of a normal map is that of its finest level, by which
/// rays of gathering see it (RayCone). But pixels look at caustic light through photons, and by a normal that is the
/// mean over what they do not resolve: where directions are stored (stores_directions) photons of kind caustic carry
/// flux x |wi.n_v| / |wi.n_g|, n_v: the normal without a map, and who looks applies map and coat (received_share).
/// Inside solids of glass it is divided by the index squared (bsdf.h). What solids absorb on the way counts as
/// absorbed. Of a surface of alpha mode BLEND only the share alpha of the photons take notice: divided by alpha they
/// stand for all that arrive. Roulette keeps the flux of a path about constant and its expectation exact.
///
/// In media (SceneFrame::media) a photon flies by null collisions under the media's majorants, raised to ten tentative
/// collisions per mean crossing of their box; its numbers are keyed by (seed, i, bounce, step). At each tentative
/// collision, real or null, a photon of kind tentative may be recorded with
///     flux / (majorant x volume_share)     [W m]
/// so that their sum over a region is the integral of the fluence over it, whatever the density there. A real one
/// scatters the albedo's share by the phase function; roulette as at surfaces.
class PhotonTracer {
 public:
  PhotonTracer(const Tracer& tracer, const Lights& lights, const PhotonOptions& options);

  std::uint64_t photon_count() const { return group_count_ * members_; }
  std::uint32_t group_count() const { return std::uint32_t(group_count_); }
  /// Batches in file order: groups ascending, each cut into pieces of kBatch paths. In a batch photons lie by waves of
  /// kWave paths, in these by bounce.
  std::size_t batch_count() const { return std::size_t(group_count_) * batches_per_group_; }
  /// Batches [first, last) of a group.
  std::pair<std::size_t, std::size_t> batches_of(std::uint32_t group) const {
    return {std::size_t(group * batches_per_group_), std::size_t((group + 1) * batches_per_group_)};
  }
  /// The frame's media as photons fly through them, or null.
  const Media* media() const { return media_ ? &*media_ : nullptr; }
  /// The majorants of flight, floor included; empty without media.
  const MajorantGrid& majorants() const;
  /// Do records have their direction: is a phase function of the media not even, or may caustic light fall on normal
  /// maps?
  bool stores_directions() const { return directions_; }
  /// Traces batch number b < batch_count(). Thread-safe.
  PhotonBatch trace(std::size_t batch) const;
  /// Traces paths first .. last - 1 of a group, also such as the map does not have (last > photon_count() /
  /// group_count()); their flux is that of the map's own paths. Thread-safe.
  PhotonBatch trace_members(std::uint32_t group, std::uint64_t first, std::uint64_t last) const;
  /// Paths of each group in the map, N_e.
  std::uint64_t members() const { return members_; }
  std::uint64_t seed() const { return options_.seed; }
  /// Traces these paths, all of one group. Thread-safe.
  PhotonBatch trace_paths(std::span<const std::uint64_t> paths) const;

  /// From now on trace() finds the paths that movers can touch: those of which a way meets their boxes, and those of
  /// lights that move or change. `watch` must outlive this; nullptr: none.
  void watch(const MoverWatch* watch);

  /// A block of 40 kB in the file: what is in flight stays in the processor's cache, and memory is the same for
  /// 10^6 photons as for 10^9.
  static constexpr std::uint64_t kBatch = 1024;

 private:
  struct Path;
  struct Draw;
  /// Photons followed together: what is known of them stays in the first-level cache.
  static constexpr std::uint64_t kWave = 64;
  static_assert(kWave <= Lights::kMostEmitted);

  /// Photons of these numbers to their ends; at most kWave. first_path: the number of the first in the caller's list.
  void follow(std::span<const std::uint64_t> numbers, std::uint32_t first_path, PhotonBatch& batch) const;
  std::size_t leave_planes_of_lights(const PhotonEmission* emissions, std::size_t arrived, Path* paths,
                                     std::uint32_t* alive, Hit* hits, SurfacePoint* points, std::uint64_t* touched,
                                     std::uint8_t* moved, PhotonBatch& batch) const;
  bool moves(const Hit& hit) const { return hit.surface >= tracer_.frame().static_count; }
  std::size_t fly(std::uint32_t bounce, std::size_t count, Path* paths, std::uint32_t* alive, Hit* hits,
                  std::uint32_t* scattered, std::size_t& scattered_count, PhotonBatch& batch) const;
  enum class Flown { through, scattered, ended };
  Flown fly_through_media(Path& path, float end, std::uint32_t bounce, PhotonBatch& batch) const;
  void record_tentative(const Path& path, Rgb flux, Vec3 position, float extinction, float majorant,
                        std::uint32_t bounce, PhotonBatch& batch) const;
  bool scatter(Path& path, SurfacePoint& point, float distance, const Draw& draw, PhotonBatch& batch) const;
  float aim(Vec3 position, Vec3 normal, const PathRandom& random, std::uint32_t bounce, Vec3& travel) const;
  bool scatter_at(Path& path, const SurfacePoint& point, float distance, const Bsdf& bsdf, float coverage, Vec3 smooth,
                  const Draw& draw, PhotonBatch& batch) const;

  const Tracer& tracer_;
  const Lights& lights_;
  PhotonOptions options_;
  PhotonHalton halton_;
  std::array<bool, 3> stores_{};   ///< by formats::PathKind
  bool has_point_lights_ = false;  ///< or spots
  bool directions_ = false;
  std::optional<Media> media_;              ///< the frame's, with raised majorants
  std::vector<char> solid_;                 ///< by material: boundary of a solid of glass
  std::vector<std::array<Bsdf, 2>> bsdfs_;  ///< by material: seen from the back, from the front
  std::vector<std::uint8_t> varies_;        ///< by material: textures decide at each hit
  std::uint64_t group_count_, members_, batches_per_group_;
  const MoverWatch* watch_ = nullptr;
  std::vector<char> slot_moves_;  ///< by slot of the emission table: the light moves or changes
};

}  // namespace tempolux
