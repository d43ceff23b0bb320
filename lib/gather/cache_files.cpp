#include "lib/gather/cache_files.h"

#include <bit>
#include <algorithm>
#include <cmath>

#include "formats/octahedral.h"
#include "lib/scene/moving_objects.h"

namespace tempolux {
namespace {

std::array<float, 3> array_of(Vec3 v) { return {v.x, v.y, v.z}; }
std::array<float, 3> array_of(const Rgb& c) { return {c.r, c.g, c.b}; }
Vec3 vec_of(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
Rgb rgb_of(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
Vec3 moved(const std::array<float, 3>& p, Vec3d shift) {
  return Vec3(Vec3d{double(p[0]) + shift.x, double(p[1]) + shift.y, double(p[2]) + shift.z});
}

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
    p.position = moved(r.position, shift);
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
    r.position = array_of(record.position);
    r.normal = array_of(record.normal);
    r.object = std::uint16_t(record.object);
    r.set = set_of(moving, record.object);
    r.irradiance = array_of(record.irradiance);
    for (std::size_t c = 0; c < 3; ++c) {
      r.rotational[c] = array_of(record.rotational[c]);
      r.translational[c] = array_of(record.translational[c]);
    }
    r.radius = record.radius;
    r.radius_unclamped = record.radius_unclamped;
    r.clearance_reach = record.clearance.reach;
    r.clearance = std::bit_cast<std::array<std::uint8_t, 16>>(record.clearance.shares);
    r.noise = array_of(record.noise);
    return r;
  });
}

std::vector<IrradianceRecord> from_file(std::span<const formats::IrradianceCacheRecord> records, Vec3d shift) {
  return converted(records, [shift](const formats::IrradianceCacheRecord& r) {
    IrradianceRecord record;
    record.position = moved(r.position, shift);
    record.normal = vec_of(r.normal);
    record.object = r.object;
    record.irradiance = rgb_of(r.irradiance);
    for (std::size_t c = 0; c < 3; ++c) {
      record.rotational[c] = vec_of(r.rotational[c]);
      record.translational[c] = vec_of(r.translational[c]);
    }
    record.radius = r.radius;
    record.radius_unclamped = r.radius_unclamped;
    record.noise = rgb_of(r.noise);
    if (r.clearance_reach > 0) record.clearance = {r.clearance_reach, std::bit_cast<Clearance::Shares>(r.clearance)};
    return record;
  });
}

}  // namespace tempolux
