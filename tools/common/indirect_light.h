// tools/common/indirect_light.h -- where a frame's caustic and indirect light comes from: photons, or a cache.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "lib/render/cache_light.h"
#include "lib/render/localised_light.h"
#include "tools/common/gather_input.h"
#include "tools/common/localised_cache.h"

namespace tempolux::tools {

struct IndirectLightOptions {
  std::string photons, irradcache, points;   ///< files, or patterns; "": none
  PhotonLightOptions photon_light;
  PointOptions points_made;                  ///< if records are missing and --points does not say what to read
  GatherOptions gather{.rays = 64};          ///< of a missing record: a pixel takes the mean of several
  InfluenceThresholds influence;             ///< of a localised cache
};

/// Opens what the options name, checked against the frame's identity, and owns it while the frame is rendered.
class IndirectLight {
 public:
  IndirectLight(Tool& tool, const IndirectLightOptions& options, const Tracer& tracer, const Lights& lights,
                int number);

  /// nullptr: none was named, trace paths.
  const DiffuseLight* get() const { return localised_ ? static_cast<const DiffuseLight*>(localised_.get()) : cache_ ? static_cast<const DiffuseLight*>(cache_.get()) : photons_.get(); }
  const std::string& history() const { return history_; }
  std::uint64_t gathered_on_the_spot() const {
    return (cache_ ? cache_->gathered_on_the_spot() : 0) + (of_frame_ ? of_frame_->gathered_on_the_spot() : 0);
  }

 private:
  void open_localised(const formats::IrradcacheFile& file, const std::string& name, int number);
  const FinalGather* make_gather(int number);

  Tool& tool_;
  const IndirectLightOptions& options_;
  const Tracer& tracer_;
  const Lights& lights_;
  std::string history_;
  std::unique_ptr<PhotonLight> photons_;
  std::unique_ptr<RecordStore> records_;
  GatherPoints points_;
  std::unique_ptr<PointLookup> lookup_;
  std::unique_ptr<FinalGather> gather_;
  std::mutex making_;
  std::unique_ptr<CacheLight> cache_;         ///< of a localised cache: over the records that stand
  std::unique_ptr<RecordStore> frame_records_;
  std::unique_ptr<InfluenceField> influence_;
  std::unique_ptr<CacheLight> of_frame_;      ///< over those gathered for the frame
  std::unique_ptr<LocalisedLight> localised_;
};

}  // namespace tempolux::tools
