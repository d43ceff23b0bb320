#include "lib/gather/gathered_record.h"

#include <algorithm>

#include "lib/core/frame.h"

namespace tempolux {

float closest_distance(const SurfacePoint& place) { return std::max(4 * place.offset, 1e-30f); }

IrradianceRecord gathered_record(const Hemisphere& sky, const SurfacePoint& place, Vec3 normal) {
  const Frame frame(normal);
  IrradianceRecord record;
  record.position = place.position;
  record.normal = normal;
  record.object = place.object;
  sky.translational_gradient(frame, record);
  sky.irradiance_and_rotational_gradient(frame, record);
  return record;
}

}  // namespace tempolux
