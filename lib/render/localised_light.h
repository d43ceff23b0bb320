// lib/render/localised_light.h -- indirect light of records that stand and of records gathered for the frame, blended.
#pragma once

#include <vector>

#include "lib/gather/localised.h"
#include "lib/render/cache_light.h"

namespace tempolux {

/// E = f E_y + (1 - f) E_t: f the gathered share of the influence there, E_t interpolated between static records that were
/// updated, E_y between those of the frame. On what moves f = 1.
class LocalisedLight : public DiffuseLight {
 public:
  /// standing: over records whose irradiance is E_t; gathered: over those of the frame. moves: by object. All but `moves` must
  /// outlive this.
  LocalisedLight(const CacheLight& standing, const CacheLight& gathered, const InfluenceField& influence, std::vector<bool> moves)
      : standing_(standing), gathered_(gathered), influence_(influence), moves_(std::move(moves)) {}

  Irradiance at(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, bool direct_view, const Rgb* caustic) const override {
    const float share = gathered_share(surface, shading);
    if (!(share < 1)) return gathered_.at(surface, geometric, shading, direct_view, caustic);
    Irradiance result = standing_.at(surface, geometric, shading, direct_view, caustic);
    if (!(share > 0)) return result;
    const Irradiance of_frame = gathered_.at(surface, geometric, shading, direct_view, &result.caustic);
    result.indirect = of_frame.indirect * share + result.indirect * (1 - share);
    return result;
  }
  float gathered_share(const SurfacePoint& surface, Vec3 shading) const {
    if (surface.object < moves_.size() && moves_[surface.object]) return 1;
    return influence_.gathered_share(surface.position, shading);
  }

 private:
  const CacheLight &standing_, &gathered_;
  const InfluenceField& influence_;
  std::vector<bool> moves_;
};

}  // namespace tempolux
