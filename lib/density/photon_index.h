// lib/density/photon_index.h -- photons near a point: exact k nearest and exact fixed radius.
//
// A balanced kd-tree whose leaves hold 32 photons, one coordinate after the other, so that eight distances
// are computed at once. Photons are kept in tree order (neighbours in space are neighbours in memory).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/core/vec.h"
#include "lib/density/box_tree.h"

namespace tempolux {

/// One bit per kind of photon, for masks.
constexpr std::uint8_t kind_bit(formats::PathKind kind) { return std::uint8_t(1u << std::uint8_t(kind)); }
inline constexpr std::uint8_t kAllKinds = 0x0f;
inline constexpr float kAnyNormal = -2;  ///< PhotonQuery::min_cos: no test of normals
inline constexpr int kMaxNeighbours = 512;

/// What is asked for. Photons that pass are those with
///
///     distance <= max_radius   and   dot(n_photon, normal) > min_cos   and   kind in kinds.
///
/// distance is computed in float as d2 = dx*dx + dy*dy + dz*dz, and with flattening f != 1 as
/// d2 + (f*f - 1) h*h, h = dot((dx,dy,dz), normal): in an ellipsoid compressed along the normal, in which
/// a metre along the normal counts f metres. max_radius is then the half-axis across the normal.
struct PhotonQuery {
  Vec3 point;     ///< m, in the photons' space (world minus the file's origin)
  Vec3 normal{};  ///< unit length; read only if min_cos > kAnyNormal or flattening != 1
  float max_radius = std::numeric_limits<float>::infinity();  ///< m, >= 0
  float min_cos = kAnyNormal;                                 ///< photons' normals are kept to 1e-3 per component
  float flattening = 1;                                       ///< >= 1
  std::uint8_t kinds = kAllKinds;
};

class PhotonIndex;

/// The photons found: parallel arrays, count() long. Reuse one per thread: it keeps its memory, and the
/// radius of its last search as a first guess for the next, which changes the speed and never the result;
/// searches are fastest if successive points are close (morton_order).
class NeighbourList {
 public:
  std::size_t count() const { return count_; }
  /// Positions in the index, for PhotonIndex::flux() and the like.
  std::span<const std::uint32_t> photons() const { return {photon_.data(), count_}; }
  /// Squared distances, m^2, in the metric of the query.
  std::span<const float> distance2() const { return {distance2_.data(), count_}; }
  /// After find_nearest that found any: the place in the list of the farthest.
  std::size_t farthest() const { return farthest_; }
  /// Puts the list into the order of (distance2, photon).
  void sort_by_distance();

 private:
  friend class PhotonIndex;
  friend struct PhotonSearch;
  std::vector<float> distance2_;
  std::vector<std::uint32_t> photon_;
  std::vector<std::uint64_t> keys_;        // of sort_by_distance()
  std::vector<std::uint32_t> bucket_end_;  // of sort_by_distance()
  std::size_t count_ = 0, farthest_ = 0;
  /// A squared radius thought to hold k photons of an index; the last few are kept.
  struct Guess {
    const PhotonIndex* index = nullptr;
    int k = 0;
    float radius2 = std::numeric_limits<float>::infinity();
  };
  Guess& guess_for(const PhotonIndex& index, int k);
  std::array<Guess, 4> guesses_;
  std::size_t oldest_guess_ = 0;
};

/// An immutable set of photons made for look-ups. Every method is thread-safe.
class PhotonIndex {
 public:
  PhotonIndex() = default;
  /// Copies what look-ups need of the photons of these kinds (kind_bit), 35 bytes per photon (16 more while it builds);
  /// the photons may go afterwards. Their positions are moved by `shift` [m]. Same index for any number of threads.
  /// O(n log n). Throws std::invalid_argument if a position or flux is not finite, std::length_error beyond 2^31
  /// photons.
  explicit PhotonIndex(std::span<const formats::Photon> photons, std::uint8_t kinds = kAllKinds, Vec3d shift = {});

  std::size_t size() const { return size_; }

  /// The k nearest photons that pass, or all of them if they are fewer, by ascending position in the index.
  /// If photons are at equal distance, the one with the lower position counts as nearer. A point that is not finite
  /// finds nothing.
  /// Throws std::invalid_argument unless 1 <= k <= kMaxNeighbours.
  void find_nearest(const PhotonQuery& query, int k, NeighbourList& found) const;

  /// All photons that pass, by ascending position in the index.
  void find_within(const PhotonQuery& query, NeighbourList& found) const;

  // One photon; i is a position in the index (tree order), < size().
  Vec3 position(std::size_t i) const {
    const Leaf& leaf = leaves_[i / kLeafSize];
    const std::size_t lane = i % kLeafSize;
    return {leaf.x[lane], leaf.y[lane], leaf.z[lane]};
  }
  Rgb flux(std::size_t i) const { return flux_[i]; }  ///< W; negative in dynamic maps
  std::uint16_t object(std::size_t i) const { return object_[i]; }
  std::uint32_t source(std::size_t i) const { return source_[i]; }  ///< place in the constructor's span
  formats::PathKind kind(std::size_t i) const;
  Vec3 normal(std::size_t i) const;  ///< as find_nearest sees it: components are multiples of 1/511

  /// Lengths below this mean nothing here: 2^-22 of the largest coordinate, m (4 to 8 float steps).
  float resolution() const { return resolution_; }

 private:
  friend struct PhotonSearch;
  static constexpr std::size_t kLeafSize = 32;
  struct alignas(64) Leaf {
    float x[kLeafSize], y[kLeafSize], z[kLeafSize];
  };
  struct alignas(64) LeafFilter {
    std::uint32_t code[kLeafSize];
  };

  struct Item;
  void build_leaves(std::span<const formats::Photon> photons, std::span<const Item> items);
  void build_tree();

  std::size_t size_ = 0, leaf_count_ = 0;
  std::unique_ptr<Leaf[]> leaves_;         // unused places hold NaN, which no comparison lets through
  std::unique_ptr<LeafFilter[]> filters_;  // normal in 3 x 10 bits, kind in 2
  std::unique_ptr<Rgb[]> flux_;
  std::unique_ptr<std::uint32_t[]> source_;
  std::unique_ptr<std::uint16_t[]> object_;
  BoxTree tree_;
  BoxTree normals_;  ///< boxes of the normals [1/511] in the same subtrees: where few face the query's way most are
                     ///< passed by
  float resolution_ = 0;
};

}  // namespace tempolux
