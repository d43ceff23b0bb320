// lib/warp/look_up.h -- finds the points of the target picture in a key.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "lib/warp/key_frame.h"
#include "lib/warp/object_motion.h"

namespace tempolux {

/// Result of a look-up. If several keys fail, the cause that comes last in this list is reported.
enum class LookUp : std::uint8_t {
  found,
  outside,    ///< outside the key's picture, or behind its camera
  hidden,     ///< inside the picture, but the key shows another surface there
  deforming,  ///< on a surface that has another shape in the key
  edge,       ///< the key shows the point only in pixels that show other surfaces, too
};

/// Weighted pixels of a key whose mean colour is the point's colour. Weights sum to 1.
struct Taps {
  int count;
  std::array<std::uint32_t, 4> pixel;
  std::array<float, 4> weight;
};

/// Points of the target that are looked up together; arrays by point.
struct WantedPoints {
  static constexpr std::size_t kMost = 64;
  std::size_t count = 0;
  std::array<RasterPoint, kMost> at;  ///< position in the target picture
  std::array<FacePoint, kMost> face;  ///< the surface there
  std::array<double, kMost> x, y, z;  ///< the point in the target camera's space; at infinity: its direction
  std::array<double, kMost> area;     ///< FrameCamera::area_of_pixel() there

  /// Computes x, y, z and area from `at` and `face`.
  void place(const FrameCamera& camera);
};

/// Results of a look-up in one key; arrays by point.
struct FoundPoints {
  std::array<LookUp, WantedPoints::kMost> result;
  std::array<Taps, WantedPoints::kMost> taps;
  /// Number of target pixels that one pixel of the key covers (docs/methods/formulas.md).
  std::array<float, WantedPoints::kMost> magnification;
};

/// One key, seen from a target camera at another frame.
class KeyView {
 public:
  /// `camera` is the camera of the key's attributes, or the same camera with more digits. `key_from_target`: motions of
  /// objects from the target's frame to the key's frame. All references must outlive this object.
  KeyView(const KeyFrame& key, const FrameCamera& camera, const FrameCamera& target,
          const ObjectMotions& key_from_target);

  /// Finds the colours of target points. A pixel of the key counts only if it is whole and shows the same face. Colour
  /// is interpolated linearly between pixel centres. If some of the four surrounding pixels do not count, the others
  /// share their weight. If none of the four counts, the closest of the 16 surrounding pixels that counts is taken. A
  /// position within kSamePixel of a pixel's centre takes this pixel alone.
  void find(const WantedPoints& wanted, FoundPoints& found) const;

  /// True if the target sees this object's pixels exactly as the key does: the same camera, and the object has not
  /// moved.
  bool sees_the_same(std::uint32_t object) const {
    return same_camera_ && motions_.of(object).kind == ObjectMotion::Kind::still;
  }
  bool same_camera() const { return same_camera_; }
  const KeyFrame& key() const { return key_; }

 private:
  /// Where a point is in the key, and the surface that the key must show there.
  struct Place {
    std::optional<RasterPoint> at;  ///< empty: not in front of the camera
    FacePoint face;                 ///< in world space at the key's frame
    double facing = 1, magnification = 1;
  };
  Place place(const WantedPoints& wanted, std::size_t i) const;
  /// Finds the pixels around a position that show the face. (cx, cy) is counted in pixels from the first pixel's
  /// centre.
  LookUp gather(double cx, double cy, const FacePoint& face, float tolerance, Taps& taps) const;

  const KeyFrame& key_;
  const FrameCamera &camera_, &target_;
  const ObjectMotions& motions_;
  bool same_camera_;
  Affine still_;               ///< key camera from target camera, for static objects
  std::vector<Affine> moved_;  ///< the same by object, for moving ones; empty: nothing moves
};

}  // namespace tempolux
