// tools/stages/still_moment.h -- reads --still: a frame of another moment, and the scene and light of that moment.
#pragma once

#include <string>

#include "lib/image/image.h"
#include "tools/stages/lit_frame.h"

namespace tempolux::tools {

/// The options of --still.
struct StillOptions {
  std::string frame;           ///< EXR file that gives most pixels; "": none
  int number = 0;              ///< frame of the animation that it shows
  IndirectLightOptions light;  ///< files with the light of that moment
};

/// Another moment of the scene, seen by the same camera.
class StillMoment {
 public:
  /// `now`: the view of the frame to render. Throws InputError if the file shows another state than the scene at
  /// options.number, if it was seen by another camera than `now`, or if the camera has a lens or an open shutter, or
  /// the scene has media: --still supports none of these.
  StillMoment(Tool& tool, SceneInput& input, const StillOptions& options, const CameraView& now, std::uint64_t seed);

  const Image& image() const { return image_; }
  const LitFrame& moment() const { return moment_; }

 private:
  Image image_;
  StaticTree tree_;
  LitFrame moment_;
};

}  // namespace tempolux::tools
