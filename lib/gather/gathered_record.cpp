#include "lib/gather/gathered_record.h"

#include <algorithm>

namespace tempolux {

float closest_distance(const SurfacePoint& place) { return std::max(4 * place.offset, 1e-30f); }

IrradianceRecord record_of_first_rays(const Hemisphere& sky, const Frame& frame, const SurfacePoint& place,
                                      Vec3 normal) {
  IrradianceRecord record;
  record.position = place.position;
  record.normal = normal;
  record.object = place.object;
  sky.translational_gradient(frame, record);
  return record;
}

}  // namespace tempolux
