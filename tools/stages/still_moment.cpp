#include "tools/stages/still_moment.h"

#include "formats/error.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"

namespace tempolux::tools {

StillMoment::StillMoment(Tool& tool, SceneInput& input, const StillOptions& options, const CameraView& now,
                         std::uint64_t seed)
    : image_(load_exr(options.frame)),
      moment_(input, options.number, input.scene().camera_node(tool.common().camera), now.width(), now.height()) {
  tool.depends_on(options.frame);
  if (now.has_lens() || now.camera().camera.shutter_frames > 0)
    throw InputError(
        "--still: the camera's lens or shutter blurs the frame; leave out one, or make it sharp with "
        "--f-stop 0 --shutter 0 (make: METHOD=frames, or FSTOP=0 SHUTTER=0)");
  if (moment_.frame().media)
    throw InputError("--still: the scene has media, which all light meets; leave out --still (make: METHOD=frames)");
  check_identity(tool, options.frame, identity_in(image_), moment_.frame());
  if (shows_other_camera(image_, {now.world_to_camera(), now.world_to_ndc()}))
    tool.refuse_stale(options.frame + ": seen by another camera than the frame is",
                      "give a frame during which the camera stands");
  moment_.build(input, tree_);
  moment_.guide_sky();
  moment_.read_light(tool, options.light, seed);
}

}  // namespace tempolux::tools
