// lib/render/stored_places.h -- where a hit of another moment lies in the scene that stored light belongs to.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/trace/trace.h"

namespace tempolux {

/// Points, records and photons lie on the surfaces of one moment. A path of another moment reads the stored light at
/// the same triangle and barycentric coordinates, so light moves with its surface.
class StoredPlaces {
 public:
  /// `here`: a moment; `stored`: the scene of the light, which must outlive this object. Both are of one Scene.
  StoredPlaces(const SceneFrame& here, const Tracer& stored);

  /// A place with its normals on the side that is lit.
  struct Place {
    SurfacePoint surface;
    Vec3 geometric, shading;  ///< unit
  };
  /// geometric, shading: the normals at the hit, on the lit side. The shading normal is turned as the surface's normal
  /// turns.
  Place of(const SurfacePoint& hit, Vec3 geometric, Vec3 shading) const;

 private:
  const Tracer& stored_;
  std::vector<std::uint32_t> surface_;  ///< by surface of the moment; kNone: not there
};

}  // namespace tempolux
