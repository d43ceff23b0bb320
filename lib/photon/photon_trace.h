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
#include "lib/material/inside.h"
#include "lib/trace/mover_watch.h"
#include "lib/trace/trace.h"
#include "lib/volume/medium.h"

namespace tempolux {

struct PhotonOptions {
  std::uint64_t seed = 0;
  std::uint64_t photon_count = 1'000'000;  ///< light paths to start; rounded up to a multiple of group_count
  std::uint32_t group_count = 0;           ///< N_g, number of groups; 0: automatic_group_count()
  bool store_direct = true, store_caustic = true, store_indirect = true;
  /// True to record tentative collisions in media; those of direct light only if store_direct is set, too. A collision
  /// is recorded with probability volume_share, and its flux is divided by volume_share. A photon has about ten
  /// collisions on its way through the media, so 0.4 records four, as many as a radiance volume can resolve
  /// (docs/methods/volume_photons.md).
  bool store_volume = false;
  float volume_share = 0.4f;
  /// True for paths alone whose first event is at a mirror or smooth glass: from lights without extent these are the
  /// paths that camera paths do not find. Light goes straight through panes, which is no event.
  bool first_event_smooth = false;
  bool store_directions = false;  ///< store the photons' directions, also where no later stage needs them
  std::uint32_t pilots = 0;  ///< the first paths of each group, this many, are pilots: hashes record what they meet

  /// Sets which kinds are stored from a list such as "direct,caustic,indirect,volume". Throws InputError if the list
  /// names no kind or another word.
  void set_kinds(const std::string& list);
  /// The stored kinds as a file's header lists them ("tentative" in place of "volume").
  std::string kinds() const;
};

/// The largest number of groups among 630 = 2 3^2 5 7, 210, 30, 6 and 1 that gives each group at least 256 light paths.
/// With media, where single groups are traced again, the largest among 2520 = 2^3 3^2 5 7, 630, 210, 30, 6 and 1 that
/// gives each group at least 64 light paths (a wave).
std::uint32_t automatic_group_count(std::uint64_t photon_count, bool media);

/// Balance of flux [W]: emitted = escaped + absorbed, up to rounding.
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

struct PhotonCounts {
  std::uint64_t path_count = 0, ray_count = 0;
  std::uint64_t specular_ray_count = 0;  ///< rays after an event S
  std::uint64_t medium_steps = 0;        ///< tentative collisions
  std::uint64_t seen_count = 0;          ///< photons stored inside the spheres of Lights::aim()

  void add(const PhotonCounts& o) {
    path_count += o.path_count, ray_count += o.ray_count, specular_ray_count += o.specular_ray_count;
    medium_steps += o.medium_steps, seen_count += o.seen_count;
  }
};

/// Result of tracing a batch of light paths: the balance is the sum over all paths, or 0 if by_path is set.
struct PhotonBatch : FluxBalance, PhotonCounts {
  formats::PhotonBlock block;                 ///< of one group
  std::vector<formats::PhotonPilot> pilots;   ///< of the group, if the group's first path is in the batch
  std::vector<formats::TouchedPath> touched;  ///< if movers are watched: the paths that movers can touch, in order
  bool by_path = false;  ///< true if the members below are filled; paths are numbered as in the list for trace_paths
  std::vector<std::uint32_t> path_of;   ///< of each photon
  std::vector<FluxBalance> balance_of;  ///< of each path
  std::vector<std::uint8_t> moved;      ///< of each path: 1 if it met a mover, or if its light moves or changes
};

/// Traces photons through one frame. Light path i starts at point i of a scrambled Halton sequence; all its other
/// random numbers are keyed by (seed, i, bounce). So the path does not depend on other paths, on the number of groups,
/// or on the number N of paths, except that its flux is emission / probability / N.
///
/// A photon is recorded at every surface with a Lambert lobe, before it is scattered, with
///     flux x arrival_weight(wi) x |wi.n_s| / |wi.n_g|     [W]
/// Here n_s is the shading normal and n_g the geometric normal. With this factor  rho/pi x density  is the radiance
/// that the Lambert lobe reflects [Veach 1997, 5.3]; on a flat matte surface the factor is 1. (Where the shading normal
/// faces away from the camera, the camera uses the geometric normal, and photons are scattered accordingly.) With a
/// normal map, n_s is the normal at the map's finest level, as for gather rays (RayCone).
///
/// A pixel that looks up caustic photons uses the mean normal of a normal map over the pixel's footprint. Therefore, if
/// directions are stored (stores_directions), a caustic photon is recorded with  flux x |wi.n_v| / |wi.n_g|, where n_v
/// is the normal without the map. The reader then applies the map and the coat (received_share). Inside glass the flux
/// is divided by the squared index of refraction (bsdf.h). Light that solids absorb counts as absorbed. On a surface of
/// alpha mode BLEND the share alpha of the photons hits the surface, and their recorded flux is divided by alpha.
/// Russian roulette keeps the flux of a path about constant, without bias.
///
/// In media (SceneFrame::media) free paths are sampled by tentative collisions against the media's majorants. The
/// majorants are raised until a mean crossing of their box has at least ten tentative collisions. Random numbers are
/// keyed by (seed, i, bounce, step). At each tentative collision, whether real or not, a photon of kind tentative is
/// recorded with the probability volume_share. In place of a flux [W] its record holds
///     flux / (majorant x volume_share)     [W m].
/// The sum over a region is the integral of fluence over the region, whatever the density of the medium. A real
/// collision scatters the albedo's share of the flux by the phase function, with Russian roulette as at surfaces.
class PhotonTracer {
 public:
  PhotonTracer(const Tracer& tracer, const Lights& lights, const PhotonOptions& options);

  /// N, number of light paths.
  std::uint64_t photon_count() const { return group_count_ * members_; }
  std::uint32_t group_count() const { return std::uint32_t(group_count_); }
  /// Number of batches. They are in file order: group after group, each cut into pieces of kBatch paths. The photons of
  /// a path follow each other by ascending bounce. With media the photons of a batch are sorted by waves of kWave
  /// paths, and within a wave by bounce.
  std::size_t batch_count() const { return std::size_t(group_count_) * batches_per_group_; }
  /// The frame's media with raised majorants, or null.
  const Media* media() const { return media_ ? &*media_ : nullptr; }
  /// The majorants in use, with the lower bound; empty without media.
  const MajorantGrid& majorants() const;
  /// True if photons store their directions: on request; if tentative photons are stored and a phase function is
  /// anisotropic; or if caustic photons are stored and caustic light may fall on normal maps.
  bool stores_directions() const { return directions_; }
  /// Traces batch number `batch` < batch_count(). Thread-safe.
  PhotonBatch trace(std::size_t batch) const;
  /// Traces paths first .. last - 1 of a group, with the flux of the map's paths. `last` may be above members().
  /// Thread- safe.
  PhotonBatch trace_members(std::uint32_t group, std::uint64_t first, std::uint64_t last) const;
  /// Number of paths in each group.
  std::uint64_t members() const { return members_; }
  std::uint64_t seed() const { return options_.seed; }
  const PhotonOptions& options() const { return options_; }
  /// Traces these paths, which must be of one group, and sets PhotonBatch::by_path. Thread-safe.
  PhotonBatch trace_paths(std::span<const std::uint64_t> paths) const;

  /// From now on trace() finds the paths that movers can touch: those with a ray that meets a box of `watch`, and those
  /// whose light moves or changes. `watch` must outlive this object; nullptr: none.
  void watch(const MoverWatch* watch) { watch_ = watch; }

  /// Number of paths in a batch, which is a block of about 40 kB in the file, so that batches fit into the processor's
  /// cache.
  static constexpr std::uint64_t kBatch = 1024;

 private:
  struct Path;
  struct Wave;
  struct Draw;
  struct Meeting;
  /// An event at a surface: its sample, the direction after it, and the factor of aim().
  struct Event {
    Bsdf::Sample next;
    Vec3 travel{};
    float aimed = 1;
  };
  Event event_at(const Path& path, const Meeting& at, const Draw& draw) const;
  /// Number of paths that are followed together; their state fits into the first-level cache.
  static constexpr std::uint64_t kWave = 64;
  static_assert(kWave <= Lights::kMostEmitted);

  /// Follows the paths of these numbers, at most kWave, to their ends. first_path: index of the first number in the
  /// caller's list.
  void follow(std::span<const std::uint64_t> numbers, std::uint32_t first_path, PhotonBatch& batch) const;
  std::size_t start(std::span<const std::uint64_t> numbers, std::uint32_t first_path, Wave& wave,
                    PhotonBatch& batch) const;
  void find_solids_of_lights();
  bool fly_on(std::size_t i, const Ray& ray, Wave& wave, PhotonBatch& batch) const;
  template <class Arrives>
  static std::size_t keep_arrived(std::size_t arrived, Wave& wave, const Arrives& arrives);
  std::size_t leave_spheres_of_lamps(std::size_t arrived, Wave& wave, PhotonBatch& batch) const;
  std::size_t leave_planes_of_lights(std::size_t arrived, Wave& wave, PhotonBatch& batch) const;
  bool moves(const Hit& hit) const { return hit.surface >= tracer_.frame().static_count; }
  std::size_t fly(std::uint32_t bounce, std::size_t count, Wave& wave, std::size_t& scattered_count,
                  PhotonBatch& batch) const;
  enum class Flown { through, scattered, ended };
  Flown fly_through_media(Path& path, float end, std::uint32_t bounce, PhotonBatch& batch) const;
  bool scatter(Path& path, SurfacePoint& point, float distance, const Draw& draw, PhotonBatch& batch) const;
  float aim(Vec3 position, Vec3 normal, const PathRandom& random, std::uint32_t bounce, Vec3& travel) const;
  void store(const Path& path, const Meeting& at, Rgb flux, std::uint32_t bounce, PhotonBatch& batch) const;
  bool bounds_solid_at(const SurfacePoint& point) const { return solid_[point.material] && !(point.plate > 0); }
  Rgb arrive(Path& path, const Meeting& at, std::uint32_t bounce, PhotonBatch& batch) const;
  bool scatter_from(Path& path, const Meeting& at, Rgb flux, const Draw& draw, PhotonBatch& batch) const;
  bool scatter_to_a_side(Path& path, Meeting& at, const MaterialValues& material, Rgb flux, const Draw& draw,
                         PhotonBatch& batch) const;

  const Tracer& tracer_;
  const Lights& lights_;
  PhotonOptions options_;
  PhotonHalton halton_;
  std::array<bool, 3> stores_{};   ///< by formats::PathKind
  bool has_point_lights_ = false;  ///< true if there are point or spot lights
  bool has_spheres_ = false;       ///< true if a point or spot light has a size
  bool directions_ = false;
  std::optional<Media> media_;              ///< the frame's media, with raised majorants
  std::vector<char> solid_;                 ///< by material: true for the boundary of solid glass
  std::vector<std::array<Bsdf, 2>> bsdfs_;  ///< by material: for light from the back, from the front
  /// By material: true if the Bsdf must be made at each hit (textures, alpha, diffuse transmission, dispersion).
  std::vector<std::uint8_t> varies_;
  std::uint64_t group_count_, members_, batches_per_group_;
  const MoverWatch* watch_ = nullptr;
  std::vector<Inside> slot_inside_;  ///< by slot: the absorbing solid that the light is in; empty: no solid absorbs
  std::vector<char> slot_moves_;     ///< by slot of the emission table: true if the light moves or changes
};

}  // namespace tempolux
