// lib/scene/same_surfaces.h -- the surfaces of one frame in another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// For each surface of `here` the surface of `other` with the same node, the same rank among that node's surfaces and
/// the same number of triangles; nullptr if there is none.
inline std::vector<const Surface*> same_surfaces(const SceneFrame& here, const SceneFrame& other) {
  std::map<std::uint32_t, std::vector<const Surface*>> by_node;
  for (const Surface& surface : other.surfaces) by_node[surface.node].push_back(&surface);
  std::map<std::uint32_t, std::size_t> rank;
  std::vector<const Surface*> same;
  for (const Surface& surface : here.surfaces) {
    const std::vector<const Surface*>& others = by_node[surface.node];
    const std::size_t r = rank[surface.node]++;
    const bool fits =
        r < others.size() && others[r]->primitive->triangles.size() == surface.primitive->triangles.size();
    same.push_back(fits ? others[r] : nullptr);
  }
  return same;
}

}  // namespace tempolux
