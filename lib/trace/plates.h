// lib/trace/plates.h -- finds plates of glass: closed solids of two parallel faces, such as window panes with a
// thickness.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lib/scene/at_frame.h"

namespace tempolux {

class Tracer;

/// A plate of glass: a closed solid whose surface is two parallel planes and a narrow rim. It shifts light sideways by
/// less than its thickness and does not change its direction (docs/methods/lights.md, "Plates").
struct Plate {
  std::vector<std::uint32_t> triangles;  ///< of both faces and of the rim
  std::vector<std::uint32_t> face;       ///< the triangles of one face
  Vec3 normal;                           ///< unit, scene space: outward at `face`
  float thickness = 0;                   ///< m
};

/// The plates among the connected parts of a surface, by geometry alone (its material is may_be_plate). A part is a
/// plate if
/// - it is closed: each edge joins two triangles that are wound alike;
/// - its faces are plane and parallel: the triangles' normals deviate from the common normal by at most 5e-4 rad on
///   average, so light is bent by less than half of that, which is a quarter of a pixel of a picture 1000 pixels wide;
/// - its rim is at most 1/20 of its area, so its thickness is at most 1/40 of the width of a square;
/// - its shading normals follow the faces.
/// Coordinates are those of the surface, so a plate may turn, and its transform may stretch it.
std::vector<Plate> find_plates(const Surface& surface);

/// The thickness [m] of the plate that each triangle of a surface bounds, 0 for none; by surfaces that have plates.
using PlatesOfSurfaces = std::unordered_map<std::uint32_t, std::vector<float>>;

/// The plates of some surfaces, without those that hold or touch other surfaces: of 64 rays that cross the plate from
/// just below a face, more than a quarter meet another surface first. Light does not pass the ground under a
/// puddle straight, but a window pane whose border lies in its frame stays a plate.
PlatesOfSurfaces free_plates(const Tracer& tracer, const std::vector<std::uint32_t>& surfaces);

}  // namespace tempolux
