// lib/scene/shutter_times.h -- the time that a camera's shutter is open, in steps of a frame.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// A frame's shutter is open from `opens` to opens + length. Times are in steps: frames of `options`, whose rate is a
/// multiple of the scene's, so that segment_between() finds what moves between frames.
struct ShutterTimes {
  /// A frame has at least 8 steps, so that a wheel that turns once in a frame moves; the shutter has at least 16.
  static constexpr double kStepsOfFrame = 8, kStepsOfShutter = 16;
  /// Most steps of a frame; a shutter that is shorter has fewer than 16.
  static constexpr double kMostSteps = 1024;

  double opens = 0, length = 0;
  TimeOptions options;

  ShutterTimes(const Camera& camera, int frame, const TimeOptions& time) : options(time) {
    const double frames = camera.shutter_frames;
    if (!(frames > 0)) return;
    const double steps = std::clamp(std::ceil(kStepsOfShutter / frames), kStepsOfFrame, kMostSteps);
    const double before = camera.shutter == Camera::Shutter::centre  ? frames / 2
                          : camera.shutter == Camera::Shutter::start ? 0
                                                                     : frames;
    options.fps *= steps;
    opens = (frame - before) * steps;
    length = frames * steps;
  }
  int first_step() const { return int(std::floor(opens)); }
  int last_step() const { return int(std::ceil(opens + length)); }
  /// The step at a share of the open time, from 0 to 1.
  double step(double share) const {
    return std::clamp(opens + length * share, double(first_step()), double(last_step()));
  }
};

}  // namespace tempolux
