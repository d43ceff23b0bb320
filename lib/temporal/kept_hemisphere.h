// lib/temporal/kept_hemisphere.h -- a record with the samples it was made from.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/radsamples/radsamples.h"
#include "lib/gather/final_gather.h"
#include "lib/irradcache/records.h"
#include "lib/temporal/sample_shelf.h"

namespace tempolux {

/// A record and its hemisphere, one sample a cell. Positions are scene space.
struct KeptHemisphere {
  formats::RadsamplesRecord record;
  std::vector<formats::RadianceSample> samples;
  std::vector<std::uint32_t> anchors;  ///< kNone: none
  SampleShelf::Place place;            ///< where they are if they are not here

  Vec3 position() const { return {record.position[0], record.position[1], record.position[2]}; }
  Vec3 normal() const { return {record.normal[0], record.normal[1], record.normal[2]}; }
  /// Number of a cell's present ray (GatherDirections::aim).
  std::uint32_t draw_of(std::uint32_t cell) const { return record.updates + 1 - formats::age_of(samples[cell]); }
};

/// What is kept of a segment between two frames.
struct KeptHemispheres {
  std::vector<KeptHemisphere> records;
  std::vector<Rgb> point_light;  ///< W/m^2 of all kinds, of the points that anchors name
  std::string
      high_hash;  ///< of what of the points' light is high: samples hold what rays bring without it; "": all of it
  bool changed = false;                ///< was there anything for the records to follow in the last frame? not in files
  std::shared_ptr<SampleShelf> shelf;  ///< for samples that are more than may stay in memory; none: all stay
};

/// Brings a record's samples here; puts them back, changed; lets go of them, unchanged; gives up their place. Without a
/// shelf they are always here.
void fetch(const KeptHemispheres& all, KeptHemisphere& kept);
void put_back(const KeptHemispheres& all, KeptHemisphere& kept);
void let_go(const KeptHemispheres& all, KeptHemisphere& kept);
void give_up(const KeptHemispheres& all, KeptHemisphere& kept);
/// A record's samples and anchors to read, from where they are; `room` holds them if they are not in memory.
struct SeenSamples {
  std::span<const formats::RadianceSample> samples;
  std::span<const std::uint32_t> anchors;
};
SeenSamples see(const KeptHemispheres& all, const KeptHemisphere& kept, KeptHemisphere& room);

/// Distances are kept in this unit, m, over 1024.
struct SampleUnits {
  float diagonal = 1;
  std::uint16_t encode(float distance) const { return formats::encode_half(distance * (1024 / diagonal)); }
  float decode(std::uint16_t distance) const { return formats::decode_half(distance) * (diagonal * (1.0f / 1024)); }
};

/// Keeps a cell's radiance; random numbers for its rounding are those of key, cell and update.
void keep_radiance(KeptHemisphere& kept, std::uint32_t cell, Rgb radiance);
/// keep_radiance of the present radiance times a ratio, by channel.
void scale_radiance(KeptHemisphere& kept, std::uint32_t cell, Rgb ratio);
/// Keeps what a ray brought, at the age that the sample has. `may_anchor`: does the light that came follow that of the
/// source's point?
void keep_ray(KeptHemisphere& kept, std::uint32_t cell, Rgb radiance, float distance, const RadianceSource& source,
              bool may_anchor, SampleUnits units);

/// Irradiance, gradients and radii, before they are limited, from the samples alone. `further_share` receives how many
/// further rays per cell the unevenness of the light would call for, if asked for.
IrradianceRecord reconstruct(const KeptHemisphere& kept, const SurfacePoint& place, SampleUnits units,
                             float* further_share = nullptr);

/// Puts into the file's record what was made of it, and back.
void keep_result(const IrradianceRecord& made, formats::RadsamplesRecord& record);
IrradianceRecord result_of(const formats::RadsamplesRecord& record);

/// What a file has beside its header and samples.
formats::RadsamplesFile head_of(const KeptHemispheres& kept);
/// Takes a record and its samples out of a file that is being read (formats::TakeSamples). `shift`: the file's origin
/// minus the frame's.
void take_samples(const formats::RadsamplesFile& head, std::size_t record, SeenSamples samples, Vec3d shift,
                  KeptHemispheres& kept);
/// Takes the rest once it is read.
void take_head(const formats::RadsamplesFile& head, KeptHemispheres& kept);

}  // namespace tempolux
