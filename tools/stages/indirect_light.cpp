#include "tools/stages/indirect_light.h"

#include <algorithm>

#include "lib/points/lamp_light.h"
#include "lib/gather/localised_file.h"
#include "lib/material/surface_material.h"
#include "lib/points/whole_photons.h"
#include "lib/scene/static_scene.h"

namespace tempolux::tools {

IndirectLight::IndirectLight(Tool& tool, const IndirectLightOptions& options, const RenderScene& scene,
                             std::uint64_t seed, int number) {
  const SceneFrame& frame = scene.frame();
  known_.lights_are_met =
      scene.lights.has_environment() ||
      std::ranges::any_of(frame.materials, [](const Material& material) { return material.emissive(); });
  if (!options.photons.empty()) read_maps(tool, options, scene.tracer, number);
  if (!options.points.empty()) read_points(tool, options, scene, seed, number);
  if (!options.meshirrad.empty()) {
    tool.stats().phase("read light texture");
    read_mesh(tool, frame_name(options.meshirrad, number), frame);
  }
  if (!options.irradcache.empty()) {
    tool.stats().phase("read cache");
    read_cache(tool, frame_name(options.irradcache, number), scene, options.influence);
  }
}

void IndirectLight::read_points(Tool& tool, const IndirectLightOptions& options, const RenderScene& scene,
                                std::uint64_t seed, int number) {
  tool.stats().phase("read points");
  points_ =
      read_divided_points(tool, frame_name(options.points, number), frame_name(options.high, number), scene.frame());
  const GatherPoints& points = points_.whole;
  history_ = points.history;
  lookup_ = std::make_unique<PointLookup>(points.points, points.spacing, point_clearance(scene.tracer));
  note_lamps_beside(scene.tracer, scene.lights, *lookup_);
  known_.points = lookup_.get();
  if (!points_.any_high()) return;
  tool.stats().phase("bright points", true);
  bright_ = std::make_unique<BrightPoints>(scene.tracer, scene.lights, *lookup_, points_.high_shares,
                                           BrightOptions{.seed = seed});
  known_.bright = bright_.get();
  tool.stats().count("bright_points", double(bright_->spot_count()));
}

void IndirectLight::read_maps(Tool& tool, const IndirectLightOptions& options, const Tracer& tracer, int number) {
  const SceneFrame& frame = tracer.frame();
  const std::string name = frame_name(options.photons, number);
  // True if photons give indirect light, too. With a map of caustic photons only, camera paths find indirect light.
  const bool alone =
      options.irradcache.empty() && options.points.empty() && options.meshirrad.empty() &&
      (options.photons_alone || formats::PhotonReader(name, {.digest = false}).header().kinds != "caustic");
  const LightNeeded needed = alone ? LightNeeded::all : LightNeeded::caustic;
  const auto shift = [&](const formats::PhotonMap& map) { return shift_of(map.header.origin, frame); };
  tool.stats().phase("read photons");
  formats::PhotonMap map;
  Vec3d moved{};
  if (!options.high.empty() && options.points.empty()) {
    map = read_divided_photons(tool, name, frame_name(options.high, number), frame, needed).whole;
    moved = shift(map);
  } else if (options.dynamic.empty()) {
    map = read_photons(tool, name, frame, {needed});
    moved = shift(map);
  } else {
    const auto wanted = [alone](Vec3, const formats::Photon& photon) {
      return alone || photon.kind == formats::PathKind::caustic;
    };
    map = read_photons(tool, name, static_scene_of(frame), {needed, "static", wanted});
    const formats::PhotonMap dynamic =
        read_photons(tool, frame_name(options.dynamic, number), frame, {needed, "dynamic", wanted});
    formats::PhotonBlock whole = whole_photons({map, dynamic, shift(map), shift(dynamic)}, wanted);
    map.photons = std::move(whole.photons);
    map.directions = std::move(whole.directions);
    map.header.history += dynamic.header.history;
  }
  history_ = map.header.history;
  tool.stats().phase("index photons", true);
  PhotonLightOptions photon_light = options.photon_light;
  photon_light.caustic_only = !alone;
  photons_ = std::make_unique<PhotonLight>(tracer, map, moved, photon_light);
  known_.photons = photons_.get();
}

void IndirectLight::read_mesh(Tool& tool, const std::string& name, const SceneFrame& frame) {
  tool.depends_on(name);
  const formats::MeshirradFile file = formats::load_meshirrad(name);
  check_identity(tool, name, file.header.identity, frame);
  if (file.header.holds == formats::MeshHolds::counts)
    throw InputError(name + ": holds counts, not light; make light of them with gather-temporal density");
  if (file.header.kinds != "indirect" && (file.header.kinds != "caustic,indirect" || photons_))
    throw InputError(name + ": holds light of kinds " + file.header.kinds +
                     ", of which frames sample or look up some by themselves; make it with --kinds indirect, or "
                     "caustic,indirect and no --photons");
  history_ = file.header.history;
  mesh_ = std::make_unique<MeshLight>(file, frame);
  known_.mesh = mesh_.get();
}

void IndirectLight::read_cache(Tool& tool, const std::string& name, const RenderScene& scene,
                               const InfluenceThresholds& thresholds) {
  const SceneFrame& frame = scene.frame();
  tool.depends_on(name);
  const formats::IrradcacheFile file = formats::load_irradcache(name);
  if (is_localised(file)) {
    check_identity(tool, name, file.header.identity, frame);
    LocalisedRecords records = localised_records(file, frame);
    history_ = records.history;
    localised_ = std::make_unique<LocalisedLight>(records.standing, records.changes, records.gathered,
                                                  records.least_cosine, thresholds, MovingObjects(frame));
    known_.localised = localised_.get();
    return;
  }
  records_ = std::make_unique<RecordStore>(float(file.header.least_cosine));
  history_ = add_records(tool, name, file, frame, *records_);
  known_.records = records_.get();
  const float apart = float(file.header.lamps_apart);
  const float reach = std::max(apart, lobes_of(frame).specular ? reach_of_spots(scene.lights, records_->records()) : 0);
  if (!(reach > 0)) return;
  no_points_ = std::make_unique<PointLookup>(std::span<const IrradiancePoint>(), reach / kBesideLamp);
  std::vector<LampPhoton> photons = photons_beside_lamps(scene.tracer, scene.lights, *no_points_);
  // Glossy rays must not read light of spots from points.
  if (lookup_)
    for (const LampPhoton& photon : photons)
      if (const PointLookup::Light* const light = lookup_->find(photon.place.position, photon.normal))
        lookup_->note_lamp(light->point);
  const auto first_far = std::ranges::stable_partition(photons, [apart](const LampPhoton& photon) {
                           return photon.lamp_distance < apart;
                         }).begin();
  const auto spots = [&](auto first, auto last) {
    return std::make_unique<BrightPoints>(scene.tracer, scene.lights, *no_points_, std::vector<float>(),
                                          BrightOptions{.beside_lamps = {first, last}});
  };
  if (apart > 0) lamp_spots_ = spots(photons.begin(), first_far);
  if (first_far != photons.end()) gloss_spots_ = spots(first_far, photons.end());
  known_.lamp_spots = lamp_spots_.get();
  known_.gloss_spots = gloss_spots_.get();
  tool.stats().count("lamp_sites", double(photons.size()));
}

}  // namespace tempolux::tools
