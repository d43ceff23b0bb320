// lib/plan/frame_pilot.h -- the pilots of one frame: what they measure for the decisions of a segment.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lib/light/lights.h"
#include "lib/pilot/choose_light.h"
#include "lib/pilot/choose_moving.h"
#include "lib/pilot/choose_preview.h"
#include "lib/pilot/choose_split.h"
#include "lib/plan/decisions.h"
#include "lib/plan/plan.h"
#include "lib/scene/at_frame.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Gives the pilots access to the scene.
struct SceneSource {
  /// The scene at a frame inside the animation; without media if `with_media` is false.
  std::function<SceneFrame(int frame, bool with_media)> at;
  std::function<EmissionTable(int frame)> emission;  ///< the emission table of the frame's segment
  int camera_node = 0;
};

/// At most 16 of `frames`, evenly spaced: a bound of the time that looking around takes.
std::vector<int> spread(const std::vector<int>& frames);

/// The result of a rough frame.
struct FrameWays {
  std::vector<Way> ways;    ///< the ways to light, the best first
  std::uint64_t paths = 0;  ///< light paths that a photon map needs (photon_paths)
  /// True if every way with this method was measured.
  bool knows(IndirectMethod method) const {
    return std::ranges::all_of(ways, [&](const Way& way) { return way.method != method || way.measured; });
  }
};

/// How the pictures of a segment share light (Order::pictures, Order::records).
struct LightSharing {
  double new_share = 0;  ///< Decisions::new_share
  /// Number of pictures that share photons and points, and the share of its records that a picture pays for (Order).
  double pictures = 1, records = 1;
  double least_hidden = kAuditLimit;  ///< RoughOptions::least_hidden
};

/// The pilots of a frame. They look through a pinhole, so that decisions do not depend on the lens.
class FramePilot {
 public:
  /// tree: the pilots of a segment share the tree of its static scene.
  FramePilot(const Wish& wish, const SceneSource& source, int number, const std::string& kinds, StaticTree& tree);

  /// Renders a rough frame of `places` places. It ends early once enough(look) is true.
  FrameWays look(int places, const LightSharing& sharing, const std::function<bool(const FrameWays&)>& enough);
  PreviewPilot preview();  ///< pilot_preview(), with aimed photons
  double kernel();         ///< pilot_kernel(): photons below the best Gaussian of a light texture
  SplitChoice split();     ///< choose_split() by a pilot
  MovingPilot moving();    ///< pilot_moving(), with aimed photons
  /// still_work() against another frame, in pieces of the picture, by camera paths.
  double still_work(const FramePilot& before, const Decisions& d) const;
  /// Mean share of a picture of the segment that the picture before does not show.
  double new_share(const PlannedSegment& segment) const;

 private:
  const Lights& aimed();

  std::string kinds_;  ///< kinds of photons that the segment may need
  const Wish& wish_;
  SceneFrame frame_;
  EmissionTable table_;
  CameraView view_;
  Tracer tracer_;
  Lights lights_;
  std::optional<EmissionTable> aimed_table_;  ///< the table of the lights aimed()
  std::optional<Lights> aimed_, without_extent_;
  std::vector<AimSphere> spheres_;
};

}  // namespace tempolux
