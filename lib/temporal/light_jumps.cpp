#include "lib/temporal/light_jumps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tempolux {
namespace {

constexpr double kLeast = 1.0 / 16;  ///< a smaller step is hidden in the noise of the filtered irradiance
/// A jump is a step larger than this many times the sum of its neighbouring steps. At the start and the end of a motion
/// one neighbouring step is about as large as the step itself, so neither is a jump.
constexpr double kLeastOverNeighbours = 2;

/// Flux of all lights without their textures, W, to compare two frames. A directional light counts 4 pi times its
/// irradiance.
double lamp_flux(const SceneFrame& frame) {
  double flux = 0;
  for (const PlacedLight& lamp : frame.lights) flux += 4 * std::numbers::pi * double(luminance(lamp.light.intensity));
  for (const Surface& s : frame.surfaces) {
    const double emission = double(luminance(frame.materials[s.material].emission));
    if (!(emission > 0)) continue;
    double area = 0;
    for (const auto& t : s.primitive->triangles) {
      const Vec3 a = s.position(t[0]), b = s.position(t[1]), c = s.position(t[2]);
      area += 0.5 * double(length(cross(b - a, c - a)));
    }
    flux += std::numbers::pi * emission * area;
  }
  return flux;
}

double step_of_lamps(const SceneFrame& a, const SceneFrame& b) {
  const double from = lamp_flux(a), to = lamp_flux(b), most = std::max(from, to);
  return most > 0 ? std::abs(to - from) / most : 0;
}

/// Largest distance that a vertex of the surface moves, divided by the diagonal of the surface's box. Comparing all
/// vertices costs less than building the search tree of the moving surfaces.
double step_of_surface(const Surface& a, const Surface& b) {
  const std::uint32_t count = std::uint32_t(a.primitive->positions.size());
  Box3 box_a, box_b;
  double furthest = 0;
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vec3 from = a.position(v), to = b.position(v);
    box_a.add(from);
    box_b.add(to);
    furthest = std::max(furthest, double(length(to - from)));
  }
  const double size = double(std::max(box_a.diagonal(), box_b.diagonal()));
  return size > 0 ? furthest / size : 0;
}

template <class Step>
bool jumps(const FramesInARow& f, const Step& step) {
  const double here = step(*f.previous, *f.here);
  if (!(here > kLeast)) return false;
  const double around =
      (f.before_previous ? step(*f.before_previous, *f.previous) : 0) + (f.next ? step(*f.here, *f.next) : 0);
  return here > kLeastOverNeighbours * around;
}

}  // namespace

bool light_jumps(const FramesInARow& frames) {
  if (!frames.previous || !frames.here) return false;
  if ((lamp_flux(*frames.previous) > 0) != (lamp_flux(*frames.here) > 0)) return true;
  if (jumps(frames, step_of_lamps)) return true;
  for (std::size_t s = frames.here->static_count; s < frames.here->surfaces.size(); ++s)
    if (jumps(frames,
              [&](const SceneFrame& a, const SceneFrame& b) { return step_of_surface(a.surfaces[s], b.surfaces[s]); }))
      return true;
  return false;
}

}  // namespace tempolux
