#include "lib/temporal/kept_hemisphere.h"

#include "lib/core/random.h"
#include "lib/gather/cache_files.h"
#include "lib/gather/hemisphere.h"

namespace tempolux {
namespace {

/// Random numbers in [0, 1) that round the mantissas of a cell's radiance in this update of the record.
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
  keep_radiance(kept, cell, rgb_of(formats::decode_rgbe(kept.samples[cell].rgbe)) * ratio);
}

void keep_ray(KeptHemisphere& kept, std::uint32_t cell, const FoundByRay& found, SampleUnits units) {
  const RadianceSource& source = found.source;
  formats::RadianceSample& sample = kept.samples[cell];
  const bool hit = found.distance < INFINITY, anchored = hit && found.may_anchor;
  sample.flags = std::uint16_t(formats::age_of(sample) | formats::sample_valid | (hit ? 0 : formats::sample_miss) |
                               (source.mover ? formats::sample_dynamic : 0) |
                               (source.partial ? formats::sample_near : 0) | (anchored ? formats::sample_anchored : 0));
  sample.distance = hit ? units.encode(found.distance) : std::uint16_t(0);
  kept.anchors[cell] = anchored ? source.point : kNone;
  keep_radiance(kept, cell, found.radiance);
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
  return sky.record(place, kept.normal());
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
  k.record.position = array_of(shifted(k.record.position, shift));
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
