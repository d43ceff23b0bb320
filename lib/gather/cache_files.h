// lib/gather/cache_files.h -- converts points and records between memory and their files.
#pragma once

#include <span>
#include <vector>

#include "formats/irradcache/irradcache.h"
#include "formats/irradpoints/irradpoints.h"
#include "lib/irradcache/points.h"
#include "lib/irradcache/records.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// Points as file records: static or dynamic by the surface on which they lie (all surfaces of an object move
/// together).
std::vector<formats::IrradiancePointRecord> to_file(std::span<const IrradiancePoint> points, const SceneFrame& frame);
/// Points of a file; `shift` (the file's origin minus the frame's) brings them into scene space.
std::vector<IrradiancePoint> from_file(std::span<const formats::IrradiancePointRecord> records, Vec3d shift);

/// Records for a file with column_clearance, and with column_noise if their noise is known.
std::vector<formats::IrradianceCacheRecord> to_file(std::span<const IrradianceRecord> records, const SceneFrame& frame);
std::vector<IrradianceRecord> from_file(std::span<const formats::IrradianceCacheRecord> records, Vec3d shift);

}  // namespace tempolux
