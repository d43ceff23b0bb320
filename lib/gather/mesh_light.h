// lib/gather/mesh_light.h -- a light texture, read at hits.
#pragma once

#include <unordered_map>

#include "formats/meshirrad/meshirrad.h"
#include "lib/scene/surface_point.h"
#include "lib/core/vec.h"

namespace tempolux {

/// Irradiance [W/m^2] of a .meshirrad file where a ray meets a surface. Thread-safe.
class MeshLight {
 public:
  explicit MeshLight(formats::MeshirradFile file);
  /// Of the element at the hit, on the side of `geometric` (unit): that towards which this normal points. 0 where the file has none.
  Rgb irradiance(const SurfacePoint& hit, Vec3 geometric) const;
  std::size_t size() const { return file_.elements.size(); }

 private:
  formats::MeshirradFile file_;
  std::unordered_map<std::uint64_t, std::uint32_t> sides_;   ///< by hash of surface, triangle, side: its first element
};

}  // namespace tempolux
