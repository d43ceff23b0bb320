// lib/light/light_tree.h -- a tree over many lights that chooses one for a point in O(log n).
//
// Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACM CGIT 1(2),
// 2018; bounds and cosines as in pbrt-v4, section 12.6.3. Eight children per node, weighed together in the
// lanes of one vector, so that a few lights cost little and many lights few levels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// What is known of one light, or of all lights below a node.
struct LightBounds {
  Box3 box;
  Vec3 axis{0, 0, 1};      ///< unit: middle of the normals
  double weight = 0;       ///< greatest irradiance at 1 m, facing it: L A, or I; summed over lights
  float cos_spread = 1;    ///< all normals are within this angle of the axis
  float cos_reach = 0;     ///< and shine no farther than this angle from their normal (at most pi/2)
  bool two_sided = false;  ///< some shine backwards as well
};

class LightTree {
 public:
  /// Weights must be positive and finite, boxes finite.
  explicit LightTree(const std::vector<LightBounds>& lights);

  bool empty() const { return nodes_.empty(); }
  /// Estimate of the irradiance that all of it gives, in the unit of weight / m^2; 0 only if no light can
  /// reach the point.
  double importance(Vec3 point, Vec3 normal) const;
  struct Choice {
    std::uint32_t light = 0;
    double probability = 0;  ///< of the light, at this point and normal
    double left = 0;         ///< what the choice left of u, in [0, 1): uniform again
  };
  /// The walk's first step, before anything is chosen. [of weight / m^2]
  static constexpr int kWidth = 8;
  struct Start {
    double each[kWidth];  ///< importance of the children, in parts of the whole tree's weight
    double sum = 0;       ///< of all, as importance()
  };
  Start start(Vec3 point, Vec3 normal) const {
    Start start;
    this->start(point, normal, start);
    return start;
  }
  void start(Vec3 point, Vec3 normal, Start& start) const;
  bool choose(const Start& start, Vec3 point, Vec3 normal, float u, Choice& choice) const;
  /// Walks down by the importance of both children: an upper bound of weight cos cos / distance^2. `normal`: unit, or
  /// zero if lights below the surface count as well. u in [0, 1). Returns false if the walk ends at a node of which no
  /// light can reach the point.
  bool choose(Vec3 point, Vec3 normal, float u, Choice& choice) const;
  /// Probability with which choose() takes this light. [1]
  double probability(Vec3 point, Vec3 normal, std::uint32_t light) const;

 private:
  struct alignas(32) Node {
    float centre[3][kWidth], radius[kWidth];  ///< of the sphere around the child's box
    float axis[3][kWidth], cos_spread[kWidth], sin_spread[kWidth], cos_reach[kWidth];
    float two_sided[kWidth];      ///< 1 or 0
    double weight[kWidth];        ///< in parts of the whole tree's; 0: no child
    std::uint32_t child[kWidth];  ///< a node, or the light of a leaf
    std::uint32_t parent;         ///< kWidth x node + lane
    std::uint8_t leaf[kWidth], count;
  };
  struct Item;
  struct Pair;
  static LightBounds build_pairs(std::vector<Item>& items, std::size_t first, std::size_t last, int depth,
                                 std::vector<Pair>& pairs);
  static std::size_t split(std::vector<Item>& items, std::size_t first, std::size_t last, bool by_cost);
  void collapse(const std::vector<Pair>& pairs, std::uint32_t pair, std::uint32_t parent);
  static void set_child(Node& node, int lane, const LightBounds& bounds);
  /// The importance of each child; returns their sum.
  double importances(const Node& node, Vec3 point, Vec3 normal, double importance[kWidth]) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> place_;  ///< by light: kWidth x node + lane
  double whole_ = 0;                  ///< sum of all weights
};

}  // namespace tempolux
