#include "tools/stages/still_moment.h"

#include "formats/error.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"
#include "lib/pilot/places_seen.h"
#include "lib/trace/solid_around.h"

namespace tempolux::tools {

StillMoment::StillMoment(Tool& tool, SceneInput& input, const StillOptions& options, const CameraView& now,
                         std::uint64_t seed)
    : frame_(input.at(options.number)), image_(load_exr(options.frame)) {
  tool.depends_on(options.frame);
  if (now.has_lens() || now.camera().camera.shutter_frames > 0)
    throw InputError(
        "--still: the camera's lens or shutter blurs the frame; leave out one, or make it sharp with "
        "--f-stop 0 --shutter 0 (make: METHOD=frames, or FSTOP=0 SHUTTER=0)");
  if (frame_.media)
    throw InputError("--still: the scene has media, which all light meets; leave out --still (make: METHOD=frames)");
  check_identity(tool, options.frame, identity_in(image_), frame_);
  const CameraMatrices camera{now.world_to_camera(), now.world_to_ndc()};
  if (shows_other_camera(image_, camera))
    tool.refuse_stale(options.frame + ": seen by another camera than the frame is",
                      "give a frame during which the camera stands");
  view_.emplace(frame_, input.scene().camera_node(tool.common().camera), now.width(), now.height());
  tracer_.emplace(frame_, tree_);
  lights_.emplace(frame_, input.emission(frame_.frame));
  const SolidAround around(*tracer_);
  scene_.emplace(RenderScene{*tracer_, *lights_, lights_->has_suns(), Inside(around(view_->eye(), {}, 0))});
  if (lights_->has_environment()) *lights_ = guided_lights(*scene_, *view_);
  light_ = std::make_unique<IndirectLight>(tool, options.light, *scene_, seed, options.number);
}

}  // namespace tempolux::tools
