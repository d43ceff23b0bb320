#include "tools/common/indirect_light.h"

#include "tools/common/localised_cache.h"

namespace tempolux::tools {

IndirectLight::IndirectLight(Tool& tool, const IndirectLightOptions& options, const Tracer& tracer, int number) {
  const SceneFrame& frame = tracer.frame();
  const bool alone = options.irradcache.empty() && options.points.empty();   // photons tell indirect light, too
  if (!options.photons.empty()) {
    tool.stats().phase("read photons");
    const formats::PhotonMap map =
        read_photons(tool, frame_name(options.photons, number), frame, alone ? LightNeeded::all : LightNeeded::caustic);
    history_ = map.header.history;
    tool.stats().phase("index photons", true);
    const Vec3d origin{map.header.origin[0], map.header.origin[1], map.header.origin[2]};
    PhotonLightOptions photon_light = options.photon_light;
    photon_light.caustic_only = !alone;
    photons_ = std::make_unique<PhotonLight>(tracer, map.photons, origin - frame.origin, photon_light);
    known_.photons = photons_.get();
  }
  if (!options.points.empty()) {
    tool.stats().phase("read points");
    points_ = read_points(tool, frame_name(options.points, number), frame);
    history_ = points_.history;
    lookup_ = std::make_unique<PointLookup>(points_.points, points_.spacing, point_clearance(tracer));
    known_.points = lookup_.get();
  }
  if (!options.irradcache.empty()) {
    tool.stats().phase("read cache");
    read_cache(tool, frame_name(options.irradcache, number), frame, options.influence);
  }
}

void IndirectLight::read_cache(Tool& tool, const std::string& name, const SceneFrame& frame, const InfluenceThresholds& thresholds) {
  tool.depends_on(name);
  const formats::IrradcacheFile file = formats::load_irradcache(name);
  if (is_localised(file)) {
    check_identity(tool, name, file.header.identity, frame);
    LocalisedRecords records = localised_records(file, frame);
    history_ = records.history;
    localised_ = std::make_unique<LocalisedLight>(records.standing, records.changes, records.gathered, records.least_cosine, thresholds,
                                                  moving_objects(frame));
    known_.localised = localised_.get();
    return;
  }
  records_ = std::make_unique<RecordStore>(InterpolationOptions{.least_cosine = 0, .only_read = true});
  history_ = add_records(tool, name, file, frame, *records_);
  known_.records = records_.get();
}

}  // namespace tempolux::tools
