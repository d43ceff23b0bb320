#include "lib/gather/cache_files.h"

#include <algorithm>
#include <cmath>

#include "formats/octahedral.h"
#include "lib/scene/moving_objects.h"

namespace tempolux {
namespace {

formats::SurfaceSet set_of(const MovingObjects& moving, std::uint32_t object) {
  return moving.contains(object) ? formats::SurfaceSet::dynamic_set : formats::SurfaceSet::static_set;
}

template <class In, class Convert>
auto converted(std::span<const In> values, Convert convert) {
  std::vector<decltype(convert(values[0]))> out;
  out.reserve(values.size());
  for (const In& value : values) out.push_back(convert(value));
  return out;
}

}  // namespace

std::vector<formats::IrradiancePointRecord> to_file(std::span<const IrradiancePoint> points, const SceneFrame& frame) {
  return converted(points, [moving = MovingObjects(frame)](const IrradiancePoint& p) {
    formats::IrradiancePointRecord r;
    r.position = array_of(p.position);
    r.normal = formats::encode_normal(array_of(p.normal));
    r.object = std::uint16_t(p.object);
    r.set = set_of(moving, p.object);
    r.radius = p.radius;
    r.direct = array_of(p.direct);
    r.caustic = array_of(p.caustic);
    r.indirect = array_of(p.indirect);
    r.noise = array_of(p.noise);
    return r;
  });
}

std::vector<IrradiancePoint> from_file(std::span<const formats::IrradiancePointRecord> records, Vec3d shift) {
  return converted(records, [shift](const formats::IrradiancePointRecord& r) {
    IrradiancePoint p;
    p.position = shifted(r.position, shift);
    p.normal = vec_of(formats::decode_normal(r.normal));
    p.object = r.object;
    p.radius = r.radius;
    p.direct = rgb_of(r.direct);
    p.caustic = rgb_of(r.caustic);
    p.indirect = rgb_of(r.indirect);
    p.noise = rgb_of(r.noise);
    return p;
  });
}

std::vector<formats::IrradianceCacheRecord> to_file(std::span<const IrradianceRecord> records,
                                                    const SceneFrame& frame) {
  return converted(records, [moving = MovingObjects(frame)](const IrradianceRecord& record) {
    formats::IrradianceCacheRecord r;
    store_values(record, r);
    r.set = set_of(moving, record.object);
    r.noise = array_of(record.noise);
    return r;
  });
}

std::vector<IrradianceRecord> from_file(std::span<const formats::IrradianceCacheRecord> records, Vec3d shift) {
  return converted(records, [shift](const formats::IrradianceCacheRecord& r) {
    IrradianceRecord record = stored_values(r);
    record.position = shifted(r.position, shift);
    record.noise = rgb_of(r.noise);
    return record;
  });
}

}  // namespace tempolux
