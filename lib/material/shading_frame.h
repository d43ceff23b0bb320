// lib/material/shading_frame.h -- the local frame of a shading normal, with the plane of the triangle below it.
#pragma once

#include <optional>

#include "lib/core/frame.h"

namespace tempolux {

/// The frame of a shading normal n, with the geometric normal g; both unit, on one side of the surface.
///
/// If n differs from g, lobes around n also send light to directions w on the wrong side of the triangle. The lobes of
/// event S send this light to the image of w instead, w - 2 (w g) g: the plane of the triangle mirrors it. So a
/// direction receives the light of two directions of the lobe, its own and its image's. No light is lost, and the rule
/// has an exact adjoint for photons (docs/methods/shading-normals.md).
class ShadingFrame : public Frame {
 public:
  ShadingFrame(Vec3 n, Vec3 g) : Frame(n), geometric_(g) {}

  bool flat() const { return normal == geometric_; }  ///< true if n = g: no direction has an image
  /// True if g faces away from light that is reflected to w (scene space), or faces light that is transmitted to w.
  bool on_wrong_side(Vec3 w, bool transmitted) const { return (transmitted ? -1.0f : 1.0f) * dot(w, geometric_) < 0; }
  /// The image of w; unit, scene space.
  Vec3 image(Vec3 w) const { return w - geometric_ * (2 * dot(w, geometric_)); }
  /// The image of a direction w (unit, local frame) in the local frame, if it is on w's side of n, so that a lobe that
  /// reaches w reaches the image as well.
  std::optional<Vec3> image_in_lobe(Vec3 w) const {
    if (flat()) return std::nullopt;
    const Vec3 g = to_local(geometric_), seen = w - g * (2 * dot(w, g));
    return seen.z * w.z > 0 ? std::optional(seen) : std::nullopt;
  }

 private:
  Vec3 geometric_;
};

}  // namespace tempolux
