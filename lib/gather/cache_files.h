// lib/gather/cache_files.h -- converts points and records between memory and their files.
#pragma once

#include <array>
#include <bit>
#include <span>
#include <vector>

#include "formats/irradcache/irradcache.h"
#include "formats/irradpoints/irradpoints.h"
#include "lib/core/arrays.h"
#include "lib/irradcache/points.h"
#include "lib/irradcache/records.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// Copies a record's place, light, radii and clearance to a record of an .irradcache or .radsamples file.
template <class FileRecord>
void store_values(const IrradianceRecord& record, FileRecord& to) {
  to.position = array_of(record.position);
  to.normal = array_of(record.normal);
  to.object = std::uint16_t(record.object);
  to.irradiance = array_of(record.irradiance);
  for (std::size_t c = 0; c < 3; ++c) {
    to.rotational[c] = array_of(record.rotational[c]);
    to.translational[c] = array_of(record.translational[c]);
  }
  to.radius = record.radius;
  to.radius_unclamped = record.radius_unclamped;
  to.clearance_reach = record.clearance.reach;
  to.clearance = std::bit_cast<std::array<std::uint8_t, 16>>(record.clearance.shares);
}
/// The inverse of store_values(). A clearance of reach 0 was not measured; the record is then valid without clearance.
template <class FileRecord>
IrradianceRecord stored_values(const FileRecord& from) {
  IrradianceRecord record;
  record.position = vec_of(from.position);
  record.normal = vec_of(from.normal);
  record.object = from.object;
  record.irradiance = rgb_of(from.irradiance);
  for (std::size_t c = 0; c < 3; ++c) {
    record.rotational[c] = vec_of(from.rotational[c]);
    record.translational[c] = vec_of(from.translational[c]);
  }
  record.radius = from.radius;
  record.radius_unclamped = from.radius_unclamped;
  if (from.clearance_reach > 0)
    record.clearance = {from.clearance_reach, std::bit_cast<Clearance::Shares>(from.clearance)};
  return record;
}

/// Points as records of a file. Points on movers are in the set dynamic, all others in the set static.
std::vector<formats::IrradiancePointRecord> to_file(std::span<const IrradiancePoint> points, const SceneFrame& frame);
/// Points of a file. `shift` [m], the file's origin minus the frame's, brings them into scene space.
std::vector<IrradiancePoint> from_file(std::span<const formats::IrradiancePointRecord> records, Vec3d shift);

/// Records of an irradiance cache as records of a file. Records on movers are in the set dynamic.
std::vector<formats::IrradianceCacheRecord> to_file(std::span<const IrradianceRecord> records, const SceneFrame& frame);
/// Records of a file; `shift` as for points.
std::vector<IrradianceRecord> from_file(std::span<const formats::IrradianceCacheRecord> records, Vec3d shift);

}  // namespace tempolux
