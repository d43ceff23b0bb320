#include "tools/stages/base_frame.h"

#include "formats/error.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"
#include "lib/image/image.h"

namespace tempolux::tools {
namespace {

std::vector<std::uint8_t> read_mask(const std::string& name, const Picture& picture) {
  const Image image = load_exr(name);
  if (image.width != picture.width || image.height != picture.height)
    throw InputError(name + ": " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                     " pixels; a mask has the size of the picture");
  return nonzero_pixels(image);
}

}  // namespace

BaseFrame read_base_frame(Tool& tool, const std::string& mask, const std::string& base, const SceneFrame& frame,
                          const Picture& picture) {
  BaseFrame result{read_mask(mask, picture), load_exr(base)};
  tool.depends_on(mask);
  tool.depends_on(base, InputRole::replaceable);
  check_identity(tool, base, identity_in(result.base), frame);
  if (shows_other_camera(result.base, picture.camera))
    tool.refuse_stale(base + ": seen by another camera than frame " + std::to_string(frame.frame) + " is",
                      "give a base of this view");
  return result;
}

}  // namespace tempolux::tools
