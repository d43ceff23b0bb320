// lib/density/box_tree.h -- a tree of boxes with eight children per node over a sequence of leaves.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// A tree of boxes. The caller orders the leaves: each aligned block of 8^j leaves is one subtree.
struct BoxTree {
  static constexpr std::size_t kChildren = 8;
  /// The boxes of a node's children. The children of level 0 are leaves. Child c of node j is number 8 j + c of the
  /// level below. Boxes of missing children are NaN, for which every comparison is false.
  struct alignas(64) Node {
    float lower[3][kChildren], upper[3][kChildren];
  };

  BoxTree() = default;
  /// `leaves`: one box for each leaf, at least one.
  explicit BoxTree(std::vector<Box3> leaves);

  std::size_t level_count() const { return level_start.size(); }
  const Node& node(std::size_t level, std::uint64_t number) const { return nodes[level_start[level] + number]; }

  std::vector<Node> nodes;                 ///< level by level, the root is last
  std::vector<std::uint32_t> level_start;  ///< index of the first node of each level
};

}  // namespace tempolux
