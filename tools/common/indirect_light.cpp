#include "tools/common/indirect_light.h"

#include "formats/error.h"
#include "lib/material/surface_material.h"

namespace tempolux::tools {

IndirectLight::IndirectLight(Tool& tool, const IndirectLightOptions& options, const Tracer& tracer,
                             const Lights& lights, int number)
    : tool_(tool), options_(options), tracer_(tracer), lights_(lights) {
  const SceneFrame& frame = tracer.frame();
  if (!options.photons.empty()) {
    const std::string name = frame_name(options.photons, number);
    tool.stats().phase("read photons");
    const formats::PhotonMap map =
        read_photons(tool, name, frame, options.irradcache.empty() ? LightNeeded::all : LightNeeded::caustic);
    history_ = map.header.history;
    tool.stats().phase("index photons", true);
    const Vec3d origin{map.header.origin[0], map.header.origin[1], map.header.origin[2]};
    PhotonLightOptions photon_light = options.photon_light;
    photon_light.caustic_only = !options.irradcache.empty();
    photons_ = std::make_unique<PhotonLight>(tracer, map.photons, origin - frame.origin, photon_light);
  }
  if (options.irradcache.empty()) return;
  const Lobes lobes = lobes_of(frame);
  if (options.photons.empty() && lobes.lambert && lobes.specular)
    tool.warn(frame.scene->path +
              ": mirrors, glass and gloss throw caustic light, which a cache does not hold: it is left out; "
              "give --photons FILE");
  tool.stats().phase("read cache");
  records_ = std::make_unique<RecordStore>(InterpolationOptions{.least_cosine = 0, .only_read = true});
  history_ = read_records(tool, frame_name(options.irradcache, number), InputRole::file, frame, *records_);
  cache_ = std::make_unique<CacheLight>(*records_, [this, number] { return make_gather(number); }, photons_.get());
}

/// Points are read, or made from the photons, when the first record is missing. Without either there would be no
/// indirect light in that place.
const FinalGather* IndirectLight::make_gather(int number) {
  if (!options_.points.empty()) points_ = read_points(tool_, frame_name(options_.points, number), tracer_.frame());
  else if (!options_.photons.empty())
    points_ =
        make_points(tool_, read_photons(tool_, frame_name(options_.photons, number), tracer_.frame(), LightNeeded::all),
                    tracer_, lights_, options_.points_made);
  else
    throw InputError(frame_name(options_.irradcache, number) +
                     ": has no record near some of what is seen, and there is nothing to "
                     "gather one from; give --points FILE or --photons FILE");
  lookup_ =
      std::make_unique<PointLookup>(points_.points, points_.spacing, point_clearance(tracer_));
  gather_ = std::make_unique<FinalGather>(tracer_, lights_, *lookup_, options_.gather);
  return gather_.get();
}

}  // namespace tempolux::tools
