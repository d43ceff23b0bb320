// tools/stages/indirect_light.h -- opens the sources of a frame's caustic and indirect light: photons, points or a
// cache.
#pragma once

#include <memory>
#include <string>

#include "lib/light_texture/mesh_light.h"
#include "lib/render/known_light.h"
#include "lib/render/localised_light.h"
#include "lib/render/path_tracer.h"
#include "tools/stages/gather_input.h"

namespace tempolux::tools {

struct IndirectLightOptions {
  std::string photons, irradcache, points, meshirrad;  ///< files, or patterns; "": none
  std::string dynamic;  ///< files or patterns, "": none; with these `photons` is the segment's static map
  /// Files or patterns, "": none; with these `points` (or, without points, `photons`) is the low part of photonmap-
  /// split.
  std::string high;
  bool photons_alone = false;  ///< true: photons must give indirect light
  PhotonLightOptions photon_light;
  InfluenceThresholds influence;  ///< for a localised cache
};

/// Opens the files of the options, checks them against the frame's identity, and owns them while the frame is rendered.
class IndirectLight {
 public:
  IndirectLight(Tool& tool, const IndirectLightOptions& options, const RenderScene& scene, std::uint64_t seed,
                int number);

  /// Empty without any file: camera paths find all light.
  const KnownLight& get() const { return known_; }
  const std::string& history() const { return history_; }

 private:
  void read_points(Tool& tool, const IndirectLightOptions& options, const RenderScene& scene, std::uint64_t seed,
                   int number);
  void read_maps(Tool& tool, const IndirectLightOptions& options, const Tracer& tracer, int number);
  void read_mesh(Tool& tool, const std::string& name, const SceneFrame& frame);
  void read_cache(Tool& tool, const std::string& name, const RenderScene& scene, const InfluenceThresholds& thresholds);

  std::string history_;
  std::unique_ptr<PhotonLight> photons_;
  std::unique_ptr<RecordStore> records_;
  DividedGatherPoints points_;
  std::unique_ptr<PointLookup> lookup_;
  std::unique_ptr<BrightPoints> bright_, lamp_spots_;
  std::unique_ptr<BrightPoints> gloss_spots_;
  std::unique_ptr<PointLookup> no_points_;  ///< holds the spacing that lamp_spots_ needs, and no points
  std::unique_ptr<LocalisedLight> localised_;
  std::unique_ptr<MeshLight> mesh_;
  KnownLight known_;
};

}  // namespace tempolux::tools
