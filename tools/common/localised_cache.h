// tools/common/localised_cache.h -- .irradcache files of localised gathering: records that stand, updated for a frame, and those
// gathered for it.
#pragma once

#include <string>
#include <vector>

#include "formats/irradcache/irradcache.h"
#include "lib/gather/localised.h"
#include "lib/irradcache/records.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// Set static: records of the standing scene, changes[i] of standing[i]. Set dynamic: records of the frame.
struct LocalisedRecords {
  std::vector<IrradianceRecord> standing, gathered;
  std::vector<RecordChange> changes;
  float least_cosine = 0;   ///< in which both count
  std::string history;
};

/// Does the file hold columns influence and update?
bool is_localised(const formats::IrradcacheFile& file);
/// Its records, in the frame's space.
LocalisedRecords localised_records(const formats::IrradcacheFile& file, const SceneFrame& frame);
/// Records as a file holds them, columns and sets filled in.
std::vector<formats::IrradianceCacheRecord> to_file(const LocalisedRecords& cache, const SceneFrame& frame);

/// --influence-low, --influence-high, --influence-absolute.
void influence_options(Tool& tool, InfluenceThresholds& thresholds);
/// InputError unless 0 <= low < high.
void check_influence(const InfluenceThresholds& thresholds);

}  // namespace tempolux::tools
