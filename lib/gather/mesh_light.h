// lib/gather/mesh_light.h -- a light texture, read at hits.
#pragma once

#include <tuple>
#include <unordered_map>
#include <vector>

#include "formats/meshirrad/meshirrad.h"
#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Irradiance [W/m^2] of a .meshirrad file where a ray meets a surface. Thread-safe.
///
/// At a corner of elements it is the mean of those that meet there, weighed by area, that face the same way (normals
/// within 30 degrees) and have the same material; within an element it is linear between its corners. So no edge
/// between elements is seen, and even light stays even.
class MeshLight {
 public:
  /// `frame`: that of the file.
  MeshLight(const formats::MeshirradFile& file, const SceneFrame& frame);
  /// At the hit, on the side of `geometric` (unit): that towards which this normal points. 0 where the file has none.
  Rgb irradiance(const SurfacePoint& hit, Vec3 geometric) const;
  std::size_t size() const { return size_; }

 private:
  struct Side {
    std::uint32_t first = 0;  ///< of its corners
    std::uint32_t cuts = 0;
  };
  /// An element at one of its corners.
  struct Meeting {
    std::uint64_t place = 0;                ///< hash of where
    std::uint32_t element = 0, corner = 0;  ///< corner: in corners_
    bool operator<(const Meeting& o) const {
      return std::tie(place, element, corner) < std::tie(o.place, o.element, o.corner);
    }
  };
  void join(std::vector<Meeting>& meetings, const std::vector<formats::MeshElement>& elements, const SceneFrame& frame);

  std::unordered_map<std::uint64_t, Side> sides_;  ///< by surface, triangle, side
  std::vector<Rgb> corners_;                       ///< of each side (n + 1) (n + 2) / 2, in rows of equal v
  std::size_t size_ = 0;                           ///< elements
};

}  // namespace tempolux
