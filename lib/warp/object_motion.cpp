#include "lib/warp/object_motion.h"

#include <cmath>
#include <map>

#include "lib/scene/deform.h"

namespace tempolux {
namespace {

/// Two shapes count as the same if no vertex differs by more than this share of the shape's size: rounding of float32.
constexpr float kSameShape = 4e-6f;

/// True if `move` (scene space to scene space) transforms the shape `here` into `there`.
bool moved_alike(const Surface& here, const Surface& there, const Affine& move) {
  if (here.positions.size() != there.positions.size()) return false;
  Box3 box;
  for (Vec3 p : here.positions) box.add(p);
  const float limit = kSameShape * (box.diagonal() + length(box.upper) + float(length(move.translation)));
  for (std::size_t i = 0; i < here.positions.size(); ++i)
    if (!(length(Vec3(move.point(Vec3d(here.positions[i]))) - there.positions[i]) <= limit)) return false;
  return true;
}

/// Surfaces by node, in the frame's order.
std::map<std::uint32_t, std::vector<const Surface*>> by_node(const SceneFrame& frame) {
  std::map<std::uint32_t, std::vector<const Surface*>> nodes;
  for (const Surface& surface : frame.surfaces) nodes[surface.node].push_back(&surface);
  return nodes;
}

/// The transform from this frame's scene space to the other frame's. The scene spaces of two segments may have
/// different origins.
Affine in_scene_space(const Affine& world_to_world, Vec3d here_origin, Vec3d other_origin) {
  Affine move = world_to_world;
  move.translation = world_to_world.point(here_origin) - other_origin;
  return move;
}

ObjectMotion motion_of(const std::vector<const Surface*>& here, const std::vector<const Surface*>& other,
                       const SceneFrame& here_frame, const SceneFrame& other_frame) {
  using Kind = ObjectMotion::Kind;
  if (here.size() != other.size()) return {Kind::absent, {}};
  const std::uint32_t node = here.front()->node;
  const Affine& world_here = here_frame.world_from_node[node];
  const Affine& world_other = other_frame.world_from_node[node];
  const bool stays = world_here == world_other;
  const bool can_be_undone = std::abs(world_here.determinant()) > 0;
  const Affine move = stays || !can_be_undone ? Affine{} : world_other * inverse(world_here);
  if (!deforms(*here_frame.scene, here_frame.scene->nodes[node])) {
    if (!stays && !can_be_undone) return {Kind::deforming, {}};
    return {stays ? Kind::still : Kind::moved, move};
  }
  const auto all_moved_by = [&](const Affine& world_to_world) {
    const Affine scene_move = in_scene_space(world_to_world, here_frame.origin, other_frame.origin);
    for (std::size_t s = 0; s < here.size(); ++s)
      if (!moved_alike(*here[s], *other[s], scene_move)) return false;
    return true;
  };
  if (all_moved_by(Affine{})) return {Kind::still, {}};  // a skin keeps the vertices in place, wherever the node moves
  if (all_moved_by(move)) return {Kind::moved, move};
  return {Kind::deforming, {}};
}

}  // namespace

ObjectMotions::ObjectMotions(const SceneFrame& here, const SceneFrame& other) {
  const auto nodes_here = by_node(here), nodes_other = by_node(other);
  for (const auto& [node, surfaces] : nodes_here) {
    const std::uint32_t object = surfaces.front()->object;
    if (object >= motions_.size()) motions_.resize(object + 1);
    const auto found = nodes_other.find(node);
    motions_[object] = found == nodes_other.end() ? ObjectMotion{ObjectMotion::Kind::absent, {}}
                                                  : motion_of(surfaces, found->second, here, other);
    all_still_ &= motions_[object].kind == ObjectMotion::Kind::still;
  }
}

std::vector<Affine> ObjectMotions::transforms(const Affine& space_from_other, const Affine& here_from_space,
                                              const Affine& still) const {
  std::vector<Affine> transforms(motions_.size(), still);
  for (std::size_t object = 0; object < motions_.size(); ++object)
    if (motions_[object].kind == ObjectMotion::Kind::moved)
      transforms[object] = space_from_other * (motions_[object].other_from_here * here_from_space);
  return transforms;
}

}  // namespace tempolux
