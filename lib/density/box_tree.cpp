#include "lib/density/box_tree.h"

#include <limits>
#include <utility>

namespace tempolux {

BoxTree::BoxTree(std::vector<Box3> boxes) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  do {
    level_start.push_back(std::uint32_t(nodes.size()));
    std::vector<Box3> parents((boxes.size() + kChildren - 1) / kChildren);
    for (std::size_t j = 0; j < parents.size(); ++j) {
      Node node;
      for (std::size_t c = 0; c < kChildren; ++c) {
        const std::size_t child = kChildren * j + c;
        const bool used = child < boxes.size();
        for (int axis = 0; axis < 3; ++axis) {
          node.lower[axis][c] = used ? boxes[child].lower[axis] : kNaN;
          node.upper[axis][c] = used ? boxes[child].upper[axis] : kNaN;
        }
        if (used) parents[j].add(boxes[child]);
      }
      nodes.push_back(node);
    }
    boxes = std::move(parents);
  } while (boxes.size() > 1);
}

}  // namespace tempolux
