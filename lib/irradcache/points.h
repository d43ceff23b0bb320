// lib/irradcache/points.h -- irradiance points: what a gather ray reads at its hit.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/core/vec.h"
#include "lib/density/photon_index.h"

namespace tempolux {

/// Irradiance at one side of a surface point, by kind of the light that arrives [W/m^2].
struct IrradiancePoint {
  Vec3 position;             ///< m, scene space
  Vec3 normal;               ///< unit, geometric, on the side that is lit
  std::uint32_t object = 0;  ///< id.object
  float radius = 0;          ///< m: of the density estimate behind `indirect`; 0: none was possible
  Rgb direct{0.0f};          ///< L D, by light sampling
  Rgb caustic{0.0f};         ///< L S+ D, by density
  Rgb indirect{0.0f};        ///< everything else, by density
  Rgb total() const { return direct + caustic + indirect; }
};

/// What a gather ray reads of a point: half a cache line instead of two.
struct alignas(32) PointLight {
  Rgb all{0.0f};            ///< W/m^2, of all kinds
  float radius = 0;         ///< as IrradiancePoint's; infinite at the edge of a spot much brighter than the mean
  Rgb first{0.0f};          ///< W/m^2, that no Lambert lobe has scattered before: direct and caustic
  std::uint32_t point : 31 = 0;        ///< index of the IrradiancePoint
  std::uint32_t shadow_edge : 1 = 0;   ///< its direct light is not that of all places near it
  Rgb total() const { return all; }
};

/// Can light at one place (with its normal on the lit side) be taken for light at the other? lib/gather's
/// Reach.
using ReachTest = std::function<bool(Vec3 from, Vec3 normal, Vec3 to, Vec3 to_normal)>;

/// Finds the point to read at a hit: the one nearest to the middle of the hit's cell (of the spacing of the
/// points) among those of the same object that face the same way, else the nearest that faces the same way.
/// A cell's answer depends on the cell alone and is remembered, so most look-ups are one table access;
/// results are the same for any number of threads.
///
/// With a reach test, hits near a point that something separates from one of its neighbours (a wall between
/// two rooms, a box on a floor: the floor under it is dark) are answered one by one: the nearest point that
/// can be reached from the hit.
class PointLookup {
 public:
  /// spacing: mean distance of neighbouring points, m, > 0. Keeps the span; it must outlive this.
  /// Cells are larger where more than 2^63 numbers of cells, directions and objects would be needed.
  PointLookup(std::span<const IrradiancePoint> points, const Box3& bounds, float spacing,
              ReachTest reach = {});
  ~PointLookup();

  /// A look-up in three steps. Memory is slow: ask for several places, then take the answers, then read them;
  /// each step fetches what the next needs.
  struct Question {
    Vec3 position, normal;
    std::uint32_t object = 0, bin = 0;
    std::array<std::uint32_t, 3> cell{};
    std::uint64_t key = 0;
  };
  struct Answer {
    std::uint32_t value = 0;
  };
  /// normal: unit, on the lit side. All thread-safe.
  Question ask(Vec3 position, Vec3 normal, std::uint32_t object) const;
  Answer answer(const Question& question) const;
  /// nullptr if no point faces this way.
  const PointLight* read(const Question& question, Answer answer) const;
  /// The three at once.
  const PointLight* find(Vec3 position, Vec3 normal, std::uint32_t object) const {
    const Question question = ask(position, normal, object);
    return read(question, answer(question));
  }
  std::size_t size() const { return points_.size(); }
  float spacing() const { return spacing_; }
  const IrradiancePoint& point(const PointLight& read) const { return points_[read.point]; }

  static constexpr std::uint32_t kNormalBins = 8;   ///< per octahedral coordinate
  static constexpr float kMostCells = 1 << 20;      ///< per axis: more than coordinates can tell apart

 private:
  static constexpr std::uint32_t kSeparated = 1;    ///< of an answer: its hits are answered one by one
  static std::uint32_t normal_bin(Vec3 n);
  Answer answer_anew(const Question& question) const;
  Answer fetched(std::uint32_t value) const;
  const PointLight* read_one_by_one(const Question& question, Answer answer) const;
  void mark_hot_edges();
  void mark_shadow_edges();
  std::uint32_t search(Vec3 position, Vec3 normal, std::uint32_t object) const;
  std::uint32_t search_cell(Vec3 middle, std::uint32_t bin, std::uint32_t object) const;
  std::uint32_t search_reachable(const Question& question, const struct PointCrowd* tried) const;
  std::uint32_t remember_crowd(Vec3 middle, Vec3 normal, std::uint32_t object) const;
  std::uint32_t reachable_in(const struct PointCrowd& crowd, const Question& question) const;
  bool separated(std::uint32_t point) const;
  bool cut(Vec3 middle, std::uint32_t nearest) const;

  std::span<const IrradiancePoint> points_;
  ReachTest reach_;
  PhotonIndex index_;
  Vec3 lower_;
  float inverse_cell_ = 0, cell_ = 0, spacing_ = 0;
  std::array<std::uint32_t, 3> size_{};  ///< of the grid, cells
  std::uint32_t objects_ = 1;            ///< ids are below it
  std::size_t mask_ = 0;
  int value_bits_ = 0;
  /// Number of cell, direction and object + 1, above value_bits_ bits of answer; 0: empty.
  mutable std::unique_ptr<std::atomic<std::uint64_t>[]> entries_;
  /// Of cells whose hits are answered one by one: the points near by.
  std::unique_ptr<struct PointCrowd[]> crowds_;
  mutable std::atomic<std::uint32_t> crowd_count_{0};
  std::vector<PointLight> lights_;                                  ///< by point
  mutable std::unique_ptr<std::atomic<std::uint8_t>[]> separated_;  ///< by point: 0 not known, 1 no, 2 yes
};

/// 3 bits of each octahedral coordinate; n need not be encoded to the last bit for that.
inline std::uint32_t PointLookup::normal_bin(Vec3 n) {
  const float scale = 1 / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  float u = n.x * scale, v = n.y * scale;
  if (n.z < 0) {
    const float folded = (1 - std::abs(v)) * std::copysign(1.0f, u);
    v = (1 - std::abs(u)) * std::copysign(1.0f, v);
    u = folded;
  }
  const auto bin = [](float x) {
    return std::min(kNormalBins - 1, std::uint32_t((x + 1) * (0.5f * kNormalBins)));
  };
  return bin(u) * kNormalBins + bin(v);
}

inline PointLookup::Question PointLookup::ask(Vec3 position, Vec3 normal, std::uint32_t object) const {
  const Vec3 local = (position - lower_) * inverse_cell_;
  const auto coordinate = [this](float x, std::size_t axis) {
    return x > 0 ? std::min(size_[axis] - 1, std::uint32_t(std::min(x, 2 * kMostCells))) : 0u;  // NaN: 0
  };
  Question q{position, normal, object, normal_bin(normal), {coordinate(local.x, 0), coordinate(local.y, 1), coordinate(local.z, 2)}, 0};
  const std::uint64_t cell = (std::uint64_t(q.cell[2]) * size_[1] + q.cell[1]) * size_[0] + q.cell[0];
  q.key = (cell * objects_ + std::min(object, objects_ - 1)) * (kNormalBins * kNormalBins) + q.bin + 1;
  __builtin_prefetch(&entries_[mix64(q.key) & mask_]);
  return q;
}

inline PointLookup::Answer PointLookup::answer(const Question& q) const {
  const std::uint64_t there = entries_[mix64(q.key) & mask_].load(std::memory_order_acquire);
  if (there >> value_bits_ != q.key || there & kSeparated) return answer_anew(q);
  const Answer answer{std::uint32_t(there & ((std::uint64_t(1) << value_bits_) - 1))};
  if (answer.value) __builtin_prefetch(&lights_[answer.value / 2 - 1]);
  return answer;
}

inline const PointLight* PointLookup::read(const Question& q, Answer answer) const {
  if (answer.value & kSeparated) return read_one_by_one(q, answer);
  return answer.value ? &lights_[answer.value / 2 - 1] : nullptr;
}

}  // namespace tempolux
