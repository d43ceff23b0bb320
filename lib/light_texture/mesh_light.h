// lib/light_texture/mesh_light.h -- reads a light texture at hits.
#pragma once

#include <compare>
#include <unordered_map>
#include <vector>

#include "formats/meshirrad/meshirrad.h"
#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Irradiance [W/m^2] of a .meshirrad file at hits. Thread-safe.
///
/// Each element has a value at each of its corners: the mean, weighted by area, over the elements that meet there, face
/// the same way (normals within 45 degrees) and have the same material. Within an element the irradiance is linear
/// between the corners. So edges between elements are invisible, and uniform light stays uniform.
class MeshLight {
 public:
  /// `frame`: the frame of the file.
  MeshLight(const formats::MeshirradFile& file, const SceneFrame& frame);
  /// Irradiance at the hit, on the side to which `geometric` (unit) points. 0 if the file has no element there.
  Rgb irradiance(const SurfacePoint& hit, Vec3 geometric) const;
  std::size_t size() const { return size_; }  ///< number of elements in the file
  /// True if the light includes caustic light.
  bool has_caustic() const { return caustic_; }

 private:
  struct Side {
    std::uint32_t first = 0;  ///< index of its first corner
    std::uint32_t cuts = 0;
  };
  /// An element at one of its corners.
  struct Meeting {
    std::uint64_t place = 0;                ///< hash of the position
    std::uint32_t element = 0, corner = 0;  ///< corner: index into corners_
    auto operator<=>(const Meeting&) const = default;
  };
  void join(std::vector<Meeting>& meetings, const std::vector<formats::MeshElement>& elements, const SceneFrame& frame);

  std::unordered_map<std::uint64_t, Side> sides_;  ///< keyed by surface, triangle, side
  std::vector<Rgb> corners_;                       ///< for each side (n + 1) (n + 2) / 2 corners, in rows of equal v
  std::size_t size_ = 0;                           ///< number of elements
  bool caustic_ = false;
};

}  // namespace tempolux
