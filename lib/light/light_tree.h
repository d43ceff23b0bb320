// lib/light/light_tree.h -- a tree over many lights that chooses one for a point in O(log n).
//
// Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACM CGIT 1(2), 2018;
// bounds and cosines as in pbrt-v4, section 12.6.3. A node has eight children whose importances are computed together
// in the lanes of a vector.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// Bounds of one light, or of all lights below a node.
struct LightBounds {
  Box3 box;
  Vec3 axis{0, 0, 1};      ///< unit; axis of the cone of normals
  double weight = 0;       ///< greatest irradiance at 1 m: L A of an area light, I of a point light; summed
  float cos_spread = 1;    ///< cosine of the largest angle between a normal and the axis
  float cos_reach = 0;     ///< cosine of the largest angle from its normal at which a light shines (at most pi/2)
  bool two_sided = false;  ///< true if any of the lights shines backwards, too
  Box3 backs_within;       ///< backs of further lights are seen from this box alone (closed_parts); empty: none
};

class LightTree {
 public:
  /// Weights must be positive and finite; boxes must be finite.
  explicit LightTree(const std::vector<LightBounds>& lights);

  bool empty() const { return nodes_.empty(); }
  struct Choice {
    std::uint32_t light = 0;
    double probability = 0;  ///< of choosing this light at this point and normal
    double left = 0;         ///< the remainder of u after the choice, in [0, 1): uniform again
  };
  static constexpr int kWidth = 8;  ///< children of a node
  /// Importances of the root's children, with which choose() begins.
  struct Start {
    double each[kWidth];  ///< importance of each child over the tree's whole weight
    /// Estimate of the irradiance at the point from all lights, in the unit of weight / m^2. 0 only if no light can
    /// reach the point.
    double sum = 0;
  };
  /// Importances at a point; a normal of zero means that lights below the surface count as well.
  Start start(Vec3 point, Vec3 normal) const;
  /// Walks down from the root. At each node a child is chosen in proportion to its importance, an upper bound of weight
  /// cos cos / distance^2. `normal` is unit; zero means that lights below the surface count as well. u in [0, 1). False
  /// if the walk ends at a node of which no light can reach the point. `start`: of the same point and normal.
  bool choose(const Start& start, Vec3 point, Vec3 normal, float u, Choice& choice) const;
  /// Probability with which choose() takes this light. [1]
  double probability(Vec3 point, Vec3 normal, std::uint32_t light) const;

 private:
  struct alignas(32) Node {
    float centre[3][kWidth], radius[kWidth];  ///< sphere around the child's box
    float axis[3][kWidth], cos_spread[kWidth], sin_spread[kWidth], cos_reach[kWidth];
    /// m^2: square of the distance from the centre within which backs are seen; -1: nowhere
    float backs_within2[kWidth];
    double weight[kWidth];        ///< over the whole tree's weight; 0: no child
    std::uint32_t child[kWidth];  ///< number of the child node, or of the light
    std::uint32_t parent;         ///< kWidth x node + lane of the parent
    std::uint8_t leaf[kWidth], count;
  };
  struct Item;
  struct Pair;
  static LightBounds build_pairs(std::vector<Item>& items, std::size_t first, std::size_t last, int depth,
                                 std::vector<Pair>& pairs);
  static std::size_t split(std::vector<Item>& items, std::size_t first, std::size_t last, bool by_cost);
  void collapse(const std::vector<Pair>& pairs, std::uint32_t pair, std::uint32_t parent);
  static void set_child(Node& node, int lane, const LightBounds& bounds);
  /// Computes the importance of each child; returns their sum.
  double importances(const Node& node, Vec3 point, Vec3 normal, double importance[kWidth]) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> place_;  ///< by light: kWidth x node + lane
  double whole_ = 0;                  ///< sum of all weights
};

}  // namespace tempolux
