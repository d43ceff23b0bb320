#include "lib/points/update_points.h"

#include <algorithm>

#include "lib/core/parallel_each.h"
#include "lib/core/random.h"
#include "lib/points/signed_density.h"

namespace tempolux {
namespace {

using formats::PathKind;
using formats::Photon;

/// True if p is inside the box, or at most `margin` [m] outside. Without branches, because it tests millions of
/// photons.
bool inside(const Box3& box, Vec3 p, float margin) {
  return (p.x >= box.lower.x - margin) & (p.x <= box.upper.x + margin) & (p.y >= box.lower.y - margin) &
         (p.y <= box.upper.y + margin) & (p.z >= box.lower.z - margin) & (p.z <= box.upper.z + margin);
}

bool near_any(const MovingBoxes& boxes, Vec3 p, float margin) {
  return inside(boxes.all, p, margin) &&
         std::any_of(boxes.surfaces.begin(), boxes.surfaces.end(),
                     [&](const Box3& box) { return !box.empty() && inside(box, p, margin); });
}

/// True if a light moves or changes, so that direct light may change at every point.
bool lights_change(const SceneFrame& frame) {
  for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s)
    if (frame.materials[frame.surfaces[s].material].emissive()) return true;
  for (const PlacedLight& placed : frame.lights)
    if (frame.segment.moves(placed.node)) return true;
  return false;
}

bool any_caustic(std::span<const Photon> photons) {
  return std::any_of(photons.begin(), photons.end(),
                     [](const Photon& photon) { return photon.kind == PathKind::caustic; });
}

/// Largest radius [m] of a density estimate: the option if it is set, or else the largest among the points. 0: neither
/// is known.
float largest_radius(const PointOptions& options, std::span<const IrradiancePoint> points) {
  float largest = options.max_radius;
  if (!(largest > 0))
    for (const IrradiancePoint& point : points) largest = std::max(largest, point.radius);
  return largest;
}

Rgb not_negative(const Rgbd& sum) {
  return Rgb(Rgbd{std::max(0.0, sum.r), std::max(0.0, sum.g), std::max(0.0, sum.b)});
}

}  // namespace

std::function<bool(Vec3, const Photon&)> static_photons_read(const SceneFrame& frame, const PointOptions& options,
                                                             std::span<const IrradiancePoint> points,
                                                             std::span<const Photon> dynamic_photons) {
  // A point is estimated again if it lies within one radius of a mover. Its photons lie within one radius of the point,
  // so within two radii of the mover.
  const float reach = 2 * largest_radius(options, points);
  return
      [boxes = moving_boxes(frame), reach, caustic = any_caustic(dynamic_photons)](Vec3 place, const Photon& photon) {
        return !(reach > 0) || (caustic && photon.kind == PathKind::caustic) || near_any(boxes, place, reach);
      };
}

PointUpdateCounts update_points(const PointUpdateInput& in, const PointOptions& options,
                                std::vector<IrradiancePoint>& points) {
  PointUpdateCounts counts;
  const SceneFrame& frame = in.whole.frame();
  // Points that found fewer static photons than `neighbours` have the largest radius of all points.
  DensityOptions density{options.neighbours, largest_radius(options, points),
                         std::min(options.area_probes, kChangeProbes)};
  const SignedDensity density_of_change(in.static_scene, in.photons.dynamic.photons, density, in.photons.dynamic_shift);
  density.max_radius = density_of_change.max_radius();
  const MovingBoxes boxes = moving_boxes(frame);
  const MoverWatch watch({boxes});
  counts.direct = update_direct(in.whole, in.lights, lights_change(frame) ? nullptr : &watch, options, points);

  std::vector<std::uint32_t> anew, others;
  float widest = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const float radius = points[i].radius > 0 ? points[i].radius : density.max_radius;
    if (near_any(boxes, points[i].position, radius)) {
      anew.push_back(i);
      widest = std::max(widest, radius);
    } else {
      others.push_back(i);
    }
  }
  counts.anew = anew.size();
  counts.changed = parallel_sum<std::size_t>(others.size(), 256, [&](std::size_t i, std::size_t& changed) {
    IrradiancePoint& point = points[others[i]];
    SignedDensity::Area area;
    const auto change =
        density_of_change.at(point.position, point.normal, point.radius, point_random(options, others[i]), area);
    if (!change) return;
    point.indirect = not_negative(Rgbd(point.indirect) + change->irradiance);
    ++changed;
  });

  // All photons that the estimates close to movers may use.
  const formats::PhotonBlock near =
      anew.empty() ? formats::PhotonBlock{} : whole_photons(in.photons, [&](Vec3 place, const Photon&) {
        return near_any(boxes, place, widest + density.max_radius);
      });
  std::vector<Rgb> caustic;
  for (const IrradiancePoint& point : points) caustic.push_back(point.caustic);
  PointOptions limited = options;
  limited.max_radius = density.max_radius;
  if (!anew.empty()) estimate_points(in.whole, in.lights, {near, {}}, limited, anew, points);

  // A caustic photon lights its own footprint, so one changed photon can reach any point. If the dynamic map holds a
  // caustic photon, re-estimate caustic light at every point.
  if (any_caustic(in.photons.dynamic.photons)) {
    const formats::PhotonBlock all =
        whole_photons(in.photons, [](Vec3, const Photon& photon) { return photon.kind == PathKind::caustic; });
    const FootprintDensity footprints(in.whole, all, {options.neighbours, options.max_radius, 0},
                                      kind_bit(PathKind::caustic), {});
    estimate_caustic(in.whole, footprints, points);
  } else {
    for (std::size_t i = 0; i < points.size(); ++i) points[i].caustic = caustic[i];
  }
  return counts;
}

}  // namespace tempolux
