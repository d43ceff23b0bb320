#include "lib/warp/flow_of_view.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "lib/core/parallel_each.h"
#include "lib/scene/same_surfaces.h"

namespace tempolux {
namespace {

/// Finds the points of this frame in a neighbouring frame.
class Neighbour {
 public:
  Neighbour(const SceneView& here, const NeighbourView& there)
      : here_(here),
        there_(there),
        motions_(here.frame(), *there.frame),
        still_(there.camera->camera_from_world() * here.camera().world_from_camera()),
        of_object_(motions_.transforms(there.camera->camera_from_world(), here.camera().world_from_camera(), still_)),
        surfaces_(same_surfaces(here.frame(), *there.frame)) {}

  /// Where the pixel's point `at` (this camera's space) is in the neighbour's camera space; for a point at infinity,
  /// its direction. Nothing if the point does not exist in the neighbour.
  std::optional<Vec3d> follow(std::size_t pixel, Vec3d at) const {
    const std::uint32_t object = here_.seen().object[pixel];
    if (object == kNoObject) return still_.direction(at);
    switch (motions_.of(object).kind) {
      case ObjectMotion::Kind::still:
      case ObjectMotion::Kind::moved: return of_object_[object].point(at);
      case ObjectMotion::Kind::absent: return std::nullopt;
      case ObjectMotion::Kind::deforming: break;
    }
    const Hit& hit = here_.hits()[pixel];
    const Surface* surface = surfaces_[hit.surface];
    if (!surface) return std::nullopt;
    const auto& corner = surface->primitive->triangles[hit.triangle];
    const auto part = [&](std::size_t i, double weight) { return Vec3d(surface->position(corner[i])) * weight; };
    const Vec3d world = part(0, 1 - double(hit.u) - double(hit.v)) + part(1, double(hit.u)) + part(2, double(hit.v)) +
                        there_.frame->origin;
    return there_.camera->camera_from_world().point(world);
  }

  const FrameCamera& camera() const { return *there_.camera; }

 private:
  const SceneView& here_;
  NeighbourView there_;
  ObjectMotions motions_;
  Affine still_;  ///< camera to camera
  std::vector<Affine> of_object_;
  std::vector<const Surface*> surfaces_;
};

/// A pixel's point in a neighbouring frame.
struct Followed {
  Vec2 flow;
  Vec3d there;  ///< in the neighbour's camera space
  bool known = false;
};

Followed follow(const Neighbour& neighbour, std::size_t pixel, Vec3d at, bool infinite, RasterPoint centre) {
  const auto there = neighbour.follow(pixel, at);
  if (!there) return {};
  const FrameCamera& camera = neighbour.camera();
  const auto raster = infinite ? camera.project_direction(*there) : camera.project(*there);
  if (!raster) return {};
  const Vec2 flow{float(raster->x - centre.x), float(centre.y - raster->y)};
  if (!std::isfinite(flow.x) || !std::isfinite(flow.y)) return {};
  return {flow, *there, true};
}

}  // namespace

double angular_speed(Vec3d a, Vec3d b, double fps) {
  return 180 / std::numbers::pi * fps * std::atan2(length(cross(a, b)), dot(a, b));
}

PixelFlow flow_of_view(const SceneView& view, const NeighbourView& next, const NeighbourView& previous, double fps) {
  const SeenSurfaces& seen = view.seen();
  PixelFlow flow(seen.width, seen.height);
  const Neighbour later(view, next), earlier(view, previous);
  parallel_each(seen.pixel_count(), 4096, [&](std::size_t p) {
    const RasterPoint centre{double(p % std::size_t(seen.width)) + 0.5, double(p / std::size_t(seen.width)) + 0.5};
    const bool nothing = !(seen.depth[p] < INFINITY);
    if (nothing && view.camera().orthographic()) return;
    const Vec3d at = nothing ? view.camera().direction(centre) : view.camera().unproject(centre, double(seen.depth[p]));
    const Followed f = follow(later, p, at, nothing, centre), b = follow(earlier, p, at, nothing, centre);
    flow.forward[p] = f.flow;
    flow.backward[p] = b.flow;
    flow.valid[p] = std::uint32_t(f.known) * forward_known + std::uint32_t(b.known) * backward_known;
    if (!view.camera().orthographic() && (f.known || b.known))
      flow.speed[p] = float(angular_speed(at, f.known ? f.there : b.there, fps));
  });
  return flow;
}

}  // namespace tempolux
