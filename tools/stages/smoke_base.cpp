#include "tools/stages/smoke_base.h"

#include <utility>

#include "lib/compose/smoke_layer.h"
#include "lib/points/gather_points.h"
#include "lib/image/frame_identity.h"

namespace tempolux::tools {

SmokeBase check_base(Tool& tool, const std::string& path, Image read, const SceneFrame& frame, const CameraView& view) {
  SmokeBase base{std::move(read), true, true};
  tool.depends_on(path, InputRole::replaceable);
  const Image& image = base.image;
  for (const char* name : {"R", "G", "B"})
    if (!image.find(name)) throw InputError(path + ": has no channels R, G, B; a base is a frame in colour");
  if (has_smoke(image))
    throw InputError(
        path + ": has smoke in its layer volume already; give a frame without, as frame-render --irradcache makes it");
  const formats::Identity identity = identity_in(image);
  if (!identity.known()) {
    base.attenuated = base.of_this_scene = false;
    tool.warn(path +
              ": does not say which scene it shows: its channel Z is where smoke ends, and it is taken as not yet "
              "dimmed by the smoke; approximate at edges");
    if (!image.find("Z"))
      throw InputError(path + ": has no channel Z; without it nobody knows what lies before the smoke");
    return base;
  }
  formats::Identity without_media = identity;
  without_media.media.clear();
  check_identity(tool, path, without_media, frame);
  if (!identity.media.empty() && identity.media != frame.hashes.media) {
    base.attenuated = false;
    tool.warn(path +
              ": was made without this smoke: it is dimmed here, a pixel at a time, and nothing in it is shaded by the "
              "smoke");
  }
  if (shows_other_camera(image, {view.world_to_camera(), view.world_to_ndc()}))
    throw InputError(path + ": seen by another camera than that of frame " + std::to_string(frame.frame) +
                     "; give a base of this view");
  return base;
}

std::string read_media_photons(Tool& tool, const std::string& path, const SceneFrame& frame, bool needs_direct,
                               MediaLight& light) {
  formats::PhotonReader reader(path, {.digest = false});
  tool.depends_on(path);
  check_identity(tool, path, reader.header().identity, frame);
  if (!holds_kind(reader.header().kinds, "tentative"))
    throw InputError(path + ": has no photons in media; trace them with --kinds volume among others");
  if (needs_direct && !holds_kind(reader.header().kinds, "direct"))
    throw InputError(path + ": has no direct light; trace it with --kinds direct among others, or use --direct rays");
  if (frame.media->directional() && !(reader.header().columns & formats::column_direction))
    throw InputError(path + ": has no directions, which a phase function with g needs; trace the photons again");
  const Vec3 offset(shift_of(reader.header().origin, frame));
  formats::PhotonBlock block;
  while (reader.read_block(block)) light.add(block, offset);
  return reader.header().history;
}

}  // namespace tempolux::tools
