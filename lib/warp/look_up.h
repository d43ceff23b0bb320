// lib/warp/look_up.h -- finding in a key what another picture shows.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/warp/key_frame.h"
#include "lib/warp/object_motion.h"

namespace tempolux {

/// What became of a look-up; of several keys' failures the last of this list says most.
enum class LookUp : std::uint8_t {
  found,
  outside,    ///< not within the key's picture, or behind it
  hidden,     ///< within it, but the key shows something else there
  deforming,  ///< of a surface that has another shape in the key
  edge,       ///< the key shows it, but only in pixels that show other surfaces too
};

/// Pixels of a key whose colours, so weighted, stand for a point. Weights sum to 1.
struct Taps {
  int count;
  std::array<std::uint32_t, 4> pixel;
  std::array<float, 4> weight;
};

/// Points of the target that are looked for together; arrays by point.
struct WantedPoints {
  static constexpr std::size_t kMost = 64;
  std::size_t count = 0;
  std::array<RasterPoint, kMost> at;  ///< where in the target
  std::array<FacePoint, kMost> face;  ///< what it shows there
  std::array<double, kMost> x, y, z;  ///< the point in its camera's space; if it is infinitely far away, its direction
  std::array<double, kMost> area;     ///< FrameCamera::area_of_pixel() there
  bool infinite = false;              ///< is any of them

  /// Fills x, y, z, area and infinite from at and face, as `camera` sees them.
  void place(const FrameCamera& camera);
};

/// What a key has of them.
struct FoundPoints {
  std::array<LookUp, WantedPoints::kMost> result;
  std::array<Taps, WantedPoints::kMost> taps;
  std::array<float, WantedPoints::kMost>
      magnification;  ///< area of target pixels per pixel of the key (docs/methods/formulas.md)
};

/// One key as a target camera at another frame makes use of it.
class KeyView {
 public:
  /// camera: the key's own, or more exactly than its attributes say. key_from_target: motions of objects from the
  /// target's frame to the key's. All references outlive this.
  KeyView(const KeyFrame& key, const FrameCamera& camera, const FrameCamera& target,
          const ObjectMotions& key_from_target);

  /// Colour for points of the target. Only
  /// whole pixels that show the same face count. Between pixel centres colour is linear; where some of the four around
  /// are of no use, the others share their weight; where all are, the nearest of the 16 around is taken. A position
  /// within kSamePixel of a centre is that pixel.
  void find(const WantedPoints& wanted, FoundPoints& found) const;

  /// Does the target see this pixel exactly as the key did: same camera, and the object where it was?
  bool sees_the_same(std::uint32_t object) const {
    return same_camera_ && motions_.of(object).kind == ObjectMotion::Kind::still;
  }
  bool same_camera() const { return same_camera_; }
  const KeyFrame& key() const { return key_; }
  const ObjectMotions& motions() const { return motions_; }

 private:
  /// Where points are in the key, and what should be seen there.
  struct Places {
    std::array<double, WantedPoints::kMost> x, y;  ///< raster; not a number: not in front of the camera
    std::array<double, WantedPoints::kMost> magnification, facing;
    std::array<FacePoint, WantedPoints::kMost> face;  ///< in the key's world
  };
  /// Looks up points that stand still and are not infinitely far away, all together.
  void place(const WantedPoints& wanted, Places& places) const;
  /// Looks up any point.
  void place_one(const WantedPoints& wanted, std::size_t i, Places& places) const;
  /// At a position of the key, counted in pixels from the centre of its first: of pixels that show the face.
  LookUp gather(double cx, double cy, const FacePoint& face, float tolerance, Taps& taps) const;

  const KeyFrame& key_;
  const FrameCamera &camera_, &target_;
  const ObjectMotions& motions_;
  bool same_camera_;
  Affine still_;               ///< key camera from target camera, of what does not move
  std::vector<Affine> moved_;  ///< the same by object, of those that do; empty: nothing moves
};

}  // namespace tempolux
