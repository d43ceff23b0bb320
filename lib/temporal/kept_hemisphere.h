// lib/temporal/kept_hemisphere.h -- a record together with its incoming radiance samples, kept from frame to frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/radsamples/radsamples.h"
#include "lib/core/arrays.h"
#include "lib/gather/final_gather.h"
#include "lib/irradcache/records.h"

namespace tempolux {

/// A record and its hemisphere: one radiance sample per cell. Positions are in scene space.
struct KeptHemisphere {
  formats::RadsamplesRecord record;
  std::vector<formats::RadianceSample> samples;
  std::vector<std::uint32_t> anchors;  ///< kNone: none

  Vec3 position() const { return vec_of(record.position); }
  Vec3 normal() const { return vec_of(record.normal); }
  /// Number of the draw of a cell's ray. The ray's random direction is a function of this number
  /// (GatherDirections::aim).
  std::uint32_t draw_of(std::uint32_t cell) const { return record.updates + 1 - formats::age_of(samples[cell]); }
};

/// All that is kept from one frame of a segment to the next.
struct KeptHemispheres {
  std::vector<KeptHemisphere> records;
  std::vector<Rgb> point_light;  ///< W/m^2, sum over kinds; anchors are indices into it
  /// Hash of the explicit shares of bright points, which the samples leave out; "": samples hold all light.
  std::string high_hash;
  bool changed = false;  ///< true if the last frame changed anything that records depend on; not stored in files
};

/// Samples and anchors of one record, by cell; anchors may be empty.
struct SeenSamples {
  std::span<const formats::RadianceSample> samples;
  std::span<const std::uint32_t> anchors;
};

/// Stored distances: half floats in units of diagonal / 1024.
struct SampleUnits {
  float diagonal = 1;  ///< m, sample_unit()
  std::uint16_t encode(float distance) const { return formats::encode_half(distance * (1024 / diagonal)); }
  float decode(std::uint16_t distance) const { return formats::decode_half(distance) * (diagonal * (1.0f / 1024)); }
};

/// Stores a cell's radiance. The random rounding depends on key, cell and update.
void keep_radiance(KeptHemisphere& kept, std::uint32_t cell, Rgb radiance);
/// Multiplies a cell's radiance by a ratio, per channel, and stores the result with keep_radiance.
void scale_radiance(KeptHemisphere& kept, std::uint32_t cell, Rgb ratio);
/// The light that a gather ray has found, and where it comes from.
struct FoundByRay {
  Rgb radiance;    ///< W/m^2/sr
  float distance;  ///< m; infinite if the ray has met nothing
  const RadianceSource& source;
  bool may_anchor;  ///< true if the radiance is proportional to the irradiance of the point that represents the hit
};
/// Stores what a cell's ray has found; the sample's age does not change.
void keep_ray(KeptHemisphere& kept, std::uint32_t cell, const FoundByRay& found, SampleUnits units);

/// Computes irradiance and gradients from the samples alone.
IrradianceRecord reconstruct(const KeptHemisphere& kept, const SurfacePoint& place, SampleUnits units);

/// A file without samples: records, the points' light, and the hash of the high part.
formats::RadsamplesFile head_of(const KeptHemispheres& kept);
/// Takes a record and its samples from a file that is being read (formats::TakeSamples). `shift` is the file's origin
/// minus the frame's.
void take_samples(const formats::RadsamplesFile& head, std::size_t record, SeenSamples samples, Vec3d shift,
                  KeptHemispheres& kept);
/// Sets the points' light and the hash of the high part in `kept` to those of `head`.
void take_head(const formats::RadsamplesFile& head, KeptHemispheres& kept);

}  // namespace tempolux
