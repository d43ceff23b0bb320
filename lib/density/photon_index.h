// lib/density/photon_index.h -- finds photons near a point: the exact k nearest, or all within a radius.
//
// A balanced kd-tree whose leaves hold 32 photons, coordinate by coordinate, so that eight distances are computed at
// once. Photons are stored in tree order: neighbours in space are neighbours in memory.
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

/// The bit of a kind of photon; a mask of kinds is the sum of its bits.
constexpr std::uint8_t kind_bit(formats::PathKind kind) { return std::uint8_t(1u << std::uint8_t(kind)); }
inline constexpr std::uint8_t kAllKinds = 0x0f;
inline constexpr float kAnyNormal = -2;  ///< value of PhotonQuery::min_cos that disables the test of normals
inline constexpr int kMaxNeighbours = 512;

/// A query. A photon passes if
///
///     distance <= max_radius   and   dot(n_photon, normal) > min_cos.
///
/// Squared distance is computed in float as d2 = dx*dx + dy*dy + dz*dz, and with flattening f != 1 as d2 + (f*f - 1)
/// h*h, h = dot((dx,dy,dz), normal): photons are then searched in an ellipsoid in which a metre along the normal counts
/// f metres, and max_radius is its half-axis perpendicular to the normal.
struct PhotonQuery {
  Vec3 point;     ///< m, in the photons' space (world minus the file's origin)
  Vec3 normal{};  ///< unit length; read only if min_cos > kAnyNormal or flattening != 1
  float max_radius = std::numeric_limits<float>::infinity();  ///< m, >= 0
  float min_cos = kAnyNormal;  ///< photons' normals are stored with an error of 1e-3 per component
  float flattening = 1;        ///< >= 1
};

class PhotonIndex;

/// The photons that a search found: parallel arrays of count() elements. Use one object per thread. The object keeps
/// its memory, and the radius of its last search as a first guess for the next search, which changes only the speed.
/// Searches are fastest if successive points are close (morton_order).
class NeighbourList {
 public:
  std::size_t count() const { return count_; }
  /// Indices into the PhotonIndex, for flux() and other look-ups.
  std::span<const std::uint32_t> photons() const { return {photon_.data(), count_}; }
  /// Squared distances, m^2, in the query's metric.
  std::span<const float> distance2() const { return {distance2_.data(), count_}; }
  /// Place of the farthest photon in the list; valid after a find_nearest that found photons.
  std::size_t farthest() const { return farthest_; }
  /// Sorts the list by (distance2, photon).
  void sort_by_distance();

 private:
  friend class PhotonIndex;
  friend struct PhotonSearch;
  std::vector<float> distance2_;
  std::vector<std::uint32_t> photon_;
  std::vector<std::uint64_t> keys_;  ///< memory for selection and sorting
  std::size_t count_ = 0, farthest_ = 0;
  /// An estimate of the squared radius [m^2] within which k photons of an index lie.
  struct Guess {
    const PhotonIndex* index = nullptr;
    int k = 0;
    float radius2 = std::numeric_limits<float>::infinity();
  };
  Guess& guess_for(const PhotonIndex& index, int k);
  std::array<Guess, 4> guesses_;
  std::size_t oldest_guess_ = 0;
};

/// An immutable set of photons for searches. Every method is thread-safe.
class PhotonIndex {
 public:
  PhotonIndex() = default;
  /// Copies the photons of these kinds (kind_bit), 33 bytes per photon (16 more during construction); the originals are
  /// not needed afterwards. Positions are moved by `shift` [m]. The same index for any number of threads. O(n log n).
  /// Throws std::invalid_argument if a position or flux is not finite, std::length_error for more than 2^31 photons.
  explicit PhotonIndex(std::span<const formats::Photon> photons, std::uint8_t kinds = kAllKinds, Vec3d shift = {});

  std::size_t size() const { return size_; }

  /// The k nearest photons that pass, or all if there are fewer, by ascending index. Of photons at equal distance the
  /// one with the lower index counts as nearer. A point that is not finite finds nothing. Throws std::invalid_argument
  /// unless 1 <= k <= kMaxNeighbours.
  void find_nearest(const PhotonQuery& query, int k, NeighbourList& found) const;

  /// All photons that pass, by ascending index.
  void find_within(const PhotonQuery& query, NeighbourList& found) const;

  /// m: position of photon i < size(), in tree order.
  Vec3 position(std::size_t i) const {
    const Leaf& leaf = leaves_[i / kLeafSize];
    const std::size_t lane = i % kLeafSize;
    return {leaf.x[lane], leaf.y[lane], leaf.z[lane]};
  }
  Rgb flux(std::size_t i) const { return flux_[i]; }                ///< W; negative in dynamic maps
  std::uint32_t source(std::size_t i) const { return source_[i]; }  ///< its index in the constructor's span
  Vec3 normal(std::size_t i) const;  ///< as searches read it: components are multiples of 1/511

  /// The smallest length that positions resolve: 2^-22 of the largest coordinate, m (4 to 8 float steps).
  float resolution() const { return resolution_; }

  static constexpr std::size_t kLeafSize = 32;  ///< photons of a leaf
  struct Item;                                  ///< a photon during construction

 private:
  friend struct PhotonSearch;
  struct alignas(64) Leaf {
    float x[kLeafSize], y[kLeafSize], z[kLeafSize];
  };
  struct alignas(64) LeafFilter {
    std::uint32_t code[kLeafSize];
  };

  void build_leaves(std::span<const formats::Photon> photons, std::span<const Item> items);
  void build_tree();

  std::size_t size_ = 0, leaf_count_ = 0;
  std::unique_ptr<Leaf[]> leaves_;         // unused places hold NaN, for which every comparison is false
  std::unique_ptr<LeafFilter[]> filters_;  // normals in 3 x 10 bits
  std::unique_ptr<Rgb[]> flux_;
  std::unique_ptr<std::uint32_t[]> source_;
  BoxTree tree_;
  /// Boxes of the normals, in units of 1/511, in the same subtrees. A search skips subtrees whose normals all fail the
  /// test of normals.
  BoxTree normals_;
  float resolution_ = 0;
};

}  // namespace tempolux
