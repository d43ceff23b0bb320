// tools/stages/lit_frame.h -- a frame of the scene as pixels see it: its camera, its lamps, and the files of its light.
#pragma once

#include <memory>
#include <optional>

#include "lib/render/pixel_samples.h"
#include "lib/trace/trace.h"
#include "tools/common/scene_input.h"
#include "tools/stages/indirect_light.h"

namespace tempolux::tools {

/// A frame of the scene with all that sampling its pixels needs: search trees, lights, and the light that files hold.
/// It is made in steps, in this order: the constructor, build(), guide_sky(), read_light(). A later step may be left
/// out.
class LitFrame {
 public:
  /// Evaluates the scene at a frame. `camera`: a node. The picture has width x height pixels.
  LitFrame(SceneInput& input, int number, int camera, int width, int height);
  LitFrame(const LitFrame&) = delete;

  /// Makes the trees and the lights. `tree` serves all frames of a segment. At each surface a reference draws one of
  /// all lights; other frames draw a sun and one of the other lights (RenderScene::suns_apart).
  void build(SceneInput& input, StaticTree& tree, bool is_reference = false);
  /// Leaves light of lamps by way of mirrors and smooth glass to light paths (RenderScene::without_hidden_light).
  void leave_out_hidden_light() { scene_->without_hidden_light = true; }
  /// Gives the lights this guide to the sky; without an argument, a guide that learns from this frame.
  void guide_sky(std::shared_ptr<const SkyGuide> guide) { *lights_ = lights_->guided(std::move(guide)); }
  void guide_sky();
  /// Opens the files of the frame's caustic and indirect light.
  void read_light(Tool& tool, const IndirectLightOptions& files, std::uint64_t seed);

  const SceneFrame& frame() const { return frame_; }
  const CameraView& view() const { return view_; }
  const Tracer& tracer() const { return *tracer_; }
  const Lights& lights() const { return *lights_; }
  const RenderScene& scene() const { return *scene_; }
  const IndirectLight& light() const { return *light_; }
  /// Samples of the frame's pixels that read the files of its light.
  CameraSampler sampler(std::uint64_t seed) const { return {*scene_, view_, &light_->get(), seed, nullptr}; }

 private:
  int number_;
  SceneFrame frame_;
  CameraView view_;
  std::optional<Tracer> tracer_;
  std::optional<Lights> lights_;
  std::optional<RenderScene> scene_;
  std::unique_ptr<IndirectLight> light_;
};

}  // namespace tempolux::tools
