#include "lib/gather/gathered_record.h"

#include <algorithm>

namespace tempolux {

float closest_distance(const SurfacePoint& place) { return std::max(4 * place.offset, 1e-30f); }

IrradianceRecord record_of_first_rays(const Hemisphere& sky, const Frame& frame, const SurfacePoint& place, Vec3 normal,
                                      float expected_share) {
  IrradianceRecord record;
  record.position = place.position;
  record.normal = normal;
  record.object = place.object;
  record.expected_share = expected_share;
  sky.translational_gradient(frame, record);
  record.lit_cells = sky.lit_cells();
  record.lit_share = record.lit_cells / float(sky.radiance.size());
  record.radius_unclamped = sky.harmonic_distance();
  record.radius = sky.nearest_across();
  return record;
}

}  // namespace tempolux
