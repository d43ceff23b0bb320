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
  const std::string name = frame_name(options.irradcache, number);
  tool.depends_on(name);
  const formats::IrradcacheFile file = formats::load_irradcache(name);
  records_ = std::make_unique<RecordStore>(InterpolationOptions{.least_cosine = 0, .only_read = true});
  if (is_localised(file)) {
    open_localised(file, name, number);
    return;
  }
  history_ = add_records(tool, name, file, frame, *records_);
  cache_ = std::make_unique<CacheLight>(*records_, [this, number] { return make_gather(number); }, photons_.get());
}

void IndirectLight::open_localised(const formats::IrradcacheFile& file, const std::string& name, int number) {
  const SceneFrame& frame = tracer_.frame();
  check_identity(tool_, name, file.header.identity, frame);
  LocalisedCache cache = localised_cache(file, frame);
  history_ = cache.history;
  std::vector<float> influences;
  for (const RecordChange& change : cache.changes) influences.push_back(change.influence);
  influence_ = std::make_unique<InfluenceField>(cache.standing, influences, options_.influence);
  // E_t in place of the static irradiance; its gradients are those of the static one.
  for (std::size_t i = 0; i < cache.standing.size(); ++i)
    for (int c = 0; c < 3; ++c) cache.standing[i].irradiance[c] = std::max(0.0f, cache.changes[i].update[c]);
  records_->narrow(cache.least_cosine);
  records_->add(cache.standing);
  frame_records_ = std::make_unique<RecordStore>(InterpolationOptions{.least_cosine = 0, .only_read = true});
  frame_records_->narrow(cache.least_cosine);
  frame_records_->add(cache.gathered);
  const auto gather = [this, number] { return make_gather(number); };
  cache_ = std::make_unique<CacheLight>(*records_, gather, photons_.get());
  of_frame_ = std::make_unique<CacheLight>(*frame_records_, gather, photons_.get());
  localised_ = std::make_unique<LocalisedLight>(*cache_, *of_frame_, *influence_, moving_objects(frame));
}

/// Points are read, or made from the photons, when the first record is missing. Without either there would be no
/// indirect light in that place.
const FinalGather* IndirectLight::make_gather(int number) {
  const std::lock_guard lock(making_);   // two caches may ask at once
  if (gather_) return gather_.get();
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
