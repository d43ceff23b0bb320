// lib/render/shutter.h -- motion blur: the scene at moments while the camera's shutter is open.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/render/stored_places.h"

namespace tempolux {

/// The frame that a shutter belongs to. All references must outlive the Shutter.
struct ShutterInput {
  const Scene& scene;
  const TimeOptions& time;
  int camera_node;
  const RenderScene& frame;  ///< the scene at the frame's time, to which stored light belongs
  const CameraView& view;
};

/// The scene, its lights and the camera at one moment.
class Moment {
 public:
  Moment(SceneFrame frame, const EmissionTable& emission, const ShutterInput& input, StaticTree& tree);
  Moment(const Moment&) = delete;
  const RenderScene& scene() const { return scene_; }
  const CameraView& view() const { return view_; }

 private:
  friend class Shutter;
  SceneFrame frame_;
  Tracer tracer_;
  Lights lights_;
  CameraView view_;
  RenderScene scene_;
};

/// All light that arrives while the shutter is open (Camera::shutter_frames) has the same weight. A sample of a pixel
/// draws one of n moments, the middles of n equal parts of this time, and its whole path sees the scene of this moment:
/// surfaces (deformed ones too), lamps and the camera are placed at this moment; nothing is interpolated between
/// moments. An edge that moves by m pixels becomes a ramp. With n moments a pixel of this ramp errs by at most (m /
/// n)^2 / (8 m), the error of the midpoint rule where the pixel's box begins or ends. n is so large that this error is
/// a quarter of a step of 8 bits, 1 / 1020, and that the edge moves by at most a pixel from one moment to the next.
/// Smoke is that of the frame's time. Materials change with time; the lens and its focus are those of the frame.
class Shutter {
 public:
  /// nullptr if the shutter is open for no time, or nothing moves while it is open.
  static std::unique_ptr<const Shutter> of(const ShutterInput& input);

  /// The moment at a share of the time that the shutter is open, in [0, 1).
  const Moment& at(float share) const {
    return *moments_[std::min(moments_.size() - 1, std::size_t(share * float(moments_.size())))];
  }
  std::size_t moment_count() const { return moments_.size(); }
  /// Longest way [pixels] of what is seen, while the shutter is open.
  double motion_px() const { return motion_px_; }

  /// Reached at 129 pixels of motion. Beyond, an edge fades in steps of more than a pixel, each of 1 / 129 of its
  /// contrast: two steps of 8 bits.
  static constexpr std::size_t kMostMoments = 129;
  /// Moments where a lamp or a material changes: a lamp that is switched at once is then off by 1 / 514 at most.
  static constexpr std::size_t kMomentsOfLamps = 257;

 private:
  Shutter() = default;
  StaticTree tree_;
  std::unique_ptr<StoredPlaces> places_;
  std::vector<std::unique_ptr<Moment>> moments_;
  double motion_px_ = 0;
};

/// What a sample sees: the scene and the view at the moment of the sample; without a shutter, at the frame's time.
struct SeenNow {
  const RenderScene& scene;
  const CameraView& view;
};

/// Draws the moment of a sample. `frame`: scene and view of the frame. shutter: may be null.
template <class Random>
SeenNow seen_now(const SeenNow& frame, const Shutter* shutter, const Random& random) {
  if (!shutter) [[likely]]
    return frame;
  // Bounce 1 of the camera's purposes is free: the time gets a sequence of its own.
  const Moment& moment = shutter->at(random.get1(1, Purpose::lens));
  return {moment.scene(), moment.view()};
}

}  // namespace tempolux
