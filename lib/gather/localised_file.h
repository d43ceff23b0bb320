// lib/gather/localised_file.h -- .irradcache files of localised gathering: records that stand, updated for a frame, and
// those gathered for it.
#pragma once

#include <string>
#include <vector>

#include "formats/irradcache/irradcache.h"
#include "lib/gather/localised.h"
#include "lib/irradcache/records.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// Set static: records of the standing scene, changes[i] of standing[i]. Set dynamic: records of the frame.
struct LocalisedRecords {
  std::vector<IrradianceRecord> standing, gathered;
  std::vector<RecordChange> changes;
  float least_cosine = 0;  ///< in which both count
  std::string history;
};

/// Does the file hold columns influence and update?
bool is_localised(const formats::IrradcacheFile& file);
/// Its records, in the frame's space.
LocalisedRecords localised_records(const formats::IrradcacheFile& file, const SceneFrame& frame);
/// Records as a file holds them, columns and sets filled in.
std::vector<formats::IrradianceCacheRecord> to_file(const LocalisedRecords& cache, const SceneFrame& frame);

}  // namespace tempolux
