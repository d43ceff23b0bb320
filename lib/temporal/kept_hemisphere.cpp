#include "lib/temporal/kept_hemisphere.h"

#include <bit>

#include "lib/core/random.h"
#include "lib/gather/gathered_record.h"
#include "lib/gather/hemisphere.h"

namespace tempolux {
namespace {

Rgb rgb_of(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
std::array<float, 3> array_of(const Rgb& c) { return {c.r, c.g, c.b}; }
std::array<float, 3> array_of(Vec3 v) { return {v.x, v.y, v.z}; }
Vec3 vec_of(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }

/// Random shares in [0, 1) by which the mantissas of a cell's radiance are rounded up in this update of the record.
std::array<float, 3> rounding_of(const formats::RadsamplesRecord& record, std::uint32_t cell) {
  const std::uint64_t bits = mix64(record.key ^ mix64(std::uint64_t(record.updates) << 32 | cell));
  const auto share = [&](int from) { return float((bits >> from) & 0x1fffff) * 0x1p-21f; };
  return {share(0), share(21), share(42)};
}

}  // namespace

void keep_radiance(KeptHemisphere& kept, std::uint32_t cell, Rgb radiance) {
  kept.samples[cell].rgbe = formats::encode_rgbe(array_of(radiance), rounding_of(kept.record, cell));
}

void scale_radiance(KeptHemisphere& kept, std::uint32_t cell, Rgb ratio) {
  std::array<std::uint8_t, 4>& rgbe = kept.samples[cell].rgbe;
  const Rgb scaled{float(rgbe[0]) * ratio.r, float(rgbe[1]) * ratio.g, float(rgbe[2]) * ratio.b};
  const float largest = max_component(scaled);
  if (rgbe[3] >= 11 && largest >= 128 && largest < 255) {  // as encode_rgbe() does it if the exponent stays the same
    const std::array<float, 3> up = rounding_of(kept.record, cell);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto whole = std::uint8_t(scaled[int(c)]);
      rgbe[c] = std::uint8_t(whole + (scaled[int(c)] - float(whole) + up[c] >= 1));
    }
    return;
  }
  const std::array<float, 3> old = formats::decode_rgbe(rgbe);
  keep_radiance(kept, cell, Rgb(old[0], old[1], old[2]) * ratio);
}

void keep_ray(KeptHemisphere& kept, std::uint32_t cell, Rgb radiance, float distance, const RadianceSource& source,
              bool may_anchor, SampleUnits units) {
  formats::RadianceSample& sample = kept.samples[cell];
  const bool hit = distance < INFINITY, anchored = hit && may_anchor;
  sample.flags = std::uint16_t(formats::age_of(sample) | formats::sample_valid | (hit ? 0 : formats::sample_miss) |
                               (source.mover ? formats::sample_dynamic : 0) |
                               (source.partial ? formats::sample_near : 0) | (anchored ? formats::sample_anchored : 0));
  sample.distance = hit ? units.encode(distance) : std::uint16_t(0);
  kept.anchors[cell] = anchored ? source.point : kNone;
  keep_radiance(kept, cell, radiance);
}

IrradianceRecord reconstruct(const KeptHemisphere& kept, const SurfacePoint& place, SampleUnits units) {
  thread_local Hemisphere sky;
  sky.reset(kept.record.rings, kept.record.sectors);
  const float closest = closest_distance(place);
  for (std::size_t c = 0; c < kept.samples.size(); ++c) {
    const formats::RadianceSample& sample = kept.samples[c];
    sky.radiance[c] = rgb_of(formats::decode_rgbe(sample.rgbe));
    if (sample.distance != 0) sky.inverse_distance[c] = 1 / std::max(units.decode(sample.distance), closest);
  }
  return gathered_record(sky, place, kept.normal());
}

void keep_result(const IrradianceRecord& made, formats::RadsamplesRecord& record) {
  record.position = array_of(made.position);
  record.normal = array_of(made.normal);
  record.object = std::uint16_t(made.object);
  record.irradiance = array_of(made.irradiance);
  for (std::size_t c = 0; c < 3; ++c) {
    record.rotational[c] = array_of(made.rotational[c]);
    record.translational[c] = array_of(made.translational[c]);
  }
  record.radius = made.radius;
  record.radius_unclamped = made.radius_unclamped;
  record.clearance_reach = made.clearance.reach;
  record.clearance = std::bit_cast<std::array<std::uint8_t, 16>>(made.clearance.shares);
}

IrradianceRecord result_of(const formats::RadsamplesRecord& record) {
  IrradianceRecord made;
  made.position = vec_of(record.position);
  made.normal = vec_of(record.normal);
  made.object = record.object;
  made.irradiance = rgb_of(record.irradiance);
  for (std::size_t c = 0; c < 3; ++c) {
    made.rotational[c] = vec_of(record.rotational[c]);
    made.translational[c] = vec_of(record.translational[c]);
  }
  made.radius = record.radius;
  made.radius_unclamped = record.radius_unclamped;
  made.clearance = {record.clearance_reach, std::bit_cast<Clearance::Shares>(record.clearance)};
  return made;
}

formats::RadsamplesFile head_of(const KeptHemispheres& kept) {
  formats::RadsamplesFile file;
  file.records.reserve(kept.records.size());
  for (const KeptHemisphere& k : kept.records) file.records.push_back(k.record);
  file.point_light.reserve(kept.point_light.size());
  for (const Rgb& light : kept.point_light) file.point_light.push_back(array_of(light));
  file.header.high_hash = kept.high_hash;
  return file;
}

void take_samples(const formats::RadsamplesFile& head, std::size_t record, SeenSamples samples, Vec3d shift,
                  KeptHemispheres& kept) {
  kept.records.resize(head.records.size());
  KeptHemisphere& k = kept.records[record];
  k.record = head.records[record];
  k.record.position = array_of(Vec3(Vec3d(vec_of(k.record.position)) + shift));
  k.samples.assign(samples.samples.begin(), samples.samples.end());
  if (samples.anchors.empty()) k.anchors.assign(k.samples.size(), kNone);
  else k.anchors.assign(samples.anchors.begin(), samples.anchors.end());
}

void take_head(const formats::RadsamplesFile& head, KeptHemispheres& kept) {
  kept.point_light.clear();
  for (const auto& light : head.point_light) kept.point_light.push_back(rgb_of(light));
  kept.high_hash = head.header.high_hash;
}

}  // namespace tempolux
