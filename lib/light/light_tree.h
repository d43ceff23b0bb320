// lib/light/light_tree.h -- a tree over many lights that chooses one for a point in O(log n).
//
// Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACM CGIT 1(2), 2018;
// bounds and cosines as in pbrt-v4, section 12.6.3. A node has eight children whose importances are computed together
// in the lanes of a vector.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// Bounds of one light, or of all lights below a node.
struct LightBounds {
  Box3 box;
  Vec3 axis{0, 0, 1};  ///< unit; axis of the cone of normals
  double weight = 0;   ///< greatest irradiance at 1 m: L A of an area light, I of a point light; summed
  /// Means over the lights by weight: of the normal n, and of (n_x^2, n_y^2, n_z^2, 2 n_x n_y, 2 n_x n_z, 2 n_y n_z).
  Vec3 mean_normal{};
  std::array<float, 6> mean_squares{};
  float cos_spread = 1;    ///< cosine of the largest angle between any light's normal and the axis
  float cos_reach = 0;     ///< cosine of the largest angle from its normal at which a light shines (at most pi/2)
  bool two_sided = false;  ///< true if any of the lights shines backwards, too
  /// Box around the closed parts (closed_parts()) to which two-sided lights belong. Only points in the box can see the
  /// backs of these lights. Empty: no such lights.
  Box3 backs_within;

  /// Adds the weight of a light with this normal (unit) to weight and means.
  void add_weight(Vec3 normal, double more);
  /// The same for a light that shines equally in all directions: its normals are estimated to have the cosine 1.
  void add_punctual(double more);
};

/// A tree over lights that chooses one light for a point.
class LightTree {
 public:
  /// Weights must be positive and finite; boxes must be finite.
  explicit LightTree(const std::vector<LightBounds>& lights);

  bool empty() const { return nodes_.empty(); }
  /// A light that choose() took.
  struct Choice {
    std::uint32_t light = 0;
    double probability = 0;  ///< of choosing this light at this point and normal
    double left = 0;         ///< the remainder of u after the choice, in [0, 1): uniform again
  };
  static constexpr int kWidth = 8;  ///< largest number of a node's children
  /// Importances of the root's children, with which choose() begins.
  struct Start {
    double each[kWidth];  ///< importance of each child divided by the weight of all lights, 1/m^2
    /// Upper estimate of the irradiance at the point from all lights: weight / m^2. 0 only if no light can reach the
    /// point.
    double sum = 0;
  };
  /// Importances at a point. `normal` is unit; if zero, lights below the surface count as well.
  Start start(Vec3 point, Vec3 normal) const;
  /// Walks down from the root. At each node a child is chosen in proportion to its importance, an estimate of weight
  /// x cos(light) cos(surface) / distance^2 that is 0 only if no light below the child can reach the point. `start` is
  /// that of the same point and normal. u in [0, 1). False if the walk ends at a node from which no light can reach the
  /// point. The tree must not be empty.
  bool choose(const Start& start, Vec3 point, Vec3 normal, float u, Choice& choice) const;
  /// Probability [1] with which choose() takes this light; 0 if it cannot.
  double probability(Vec3 point, Vec3 normal, std::uint32_t light) const;

 private:
  struct alignas(32) Node {
    float centre[3][kWidth], radius[kWidth];  ///< sphere around the child's box
    float axis[3][kWidth], cos_spread[kWidth], sin_spread[kWidth], cos_reach[kWidth];
    float normals[3][kWidth], squares[6][kWidth];  ///< LightBounds::mean_normal, mean_squares
    /// m^2; square of the distance from the centre within which backs may be seen; -1: backs are seen nowhere
    float backs_within2[kWidth];
    double weight[kWidth];        ///< of the child, divided by the weight of all lights; 0: no child
    std::uint32_t child[kWidth];  ///< number of the child node, or of the light
    std::uint32_t parent;         ///< kWidth x (number of the parent node) + this node's lane in it
    std::uint8_t leaf[kWidth], count;
  };
  struct Item;
  struct Pair;
  static LightBounds build_pairs(std::vector<Item>& items, std::size_t first, std::size_t last, int depth,
                                 std::vector<Pair>& pairs);
  static std::size_t split(std::vector<Item>& items, std::size_t first, std::size_t last, bool by_cost);
  void collapse(const std::vector<Pair>& pairs, std::uint32_t pair, std::uint32_t parent);
  void set_child(Node& node, int lane, const LightBounds& bounds) const;
  /// Computes the importance of each child; returns their sum.
  double importances(const Node& node, Vec3 point, Vec3 normal, double importance[kWidth]) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> place_;  ///< for each light, kWidth x (number of its node) + its lane
  double whole_ = 0;                  ///< sum of all lights' weights
};

}  // namespace tempolux
