// tools/stages/still_moment.h -- reads --still: a frame of another moment, and the scene and light of that moment.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/pixel_samples.h"
#include "lib/trace/trace.h"
#include "tools/common/scene_input.h"
#include "tools/stages/indirect_light.h"

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
  /// options.number, or if its camera is not that of `now`.
  StillMoment(Tool& tool, SceneInput& input, const StillOptions& options, const CameraView& now, std::uint64_t seed);

  const Image& image() const { return image_; }
  const RenderScene& scene() const { return *scene_; }
  /// The sky as places of this moment see it: both moments must draw the same directions.
  const std::shared_ptr<const SkyGuide>& guide() const { return lights_->guide(); }
  CameraSampler sampler(std::uint64_t seed) const { return {*scene_, *view_, &light_->get(), seed, nullptr}; }

 private:
  SceneFrame frame_;
  Image image_;
  StaticTree tree_;
  std::optional<Tracer> tracer_;
  std::optional<Lights> lights_;
  std::optional<CameraView> view_;
  std::optional<RenderScene> scene_;
  std::unique_ptr<IndirectLight> light_;
};

}  // namespace tempolux::tools
