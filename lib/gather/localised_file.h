// lib/gather/localised_file.h -- .irradcache files of localised gathering: static records, updated for a frame, and
// records gathered for it.
#pragma once

#include <string>
#include <vector>

#include "formats/irradcache/irradcache.h"
#include "lib/gather/localised.h"
#include "lib/irradcache/records.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// The records of a frame. `standing` belong to the static scene, and changes[i] belongs to standing[i]; `gathered`
/// were gathered for the frame. In the file they have the sets static and dynamic.
struct LocalisedRecords {
  std::vector<IrradianceRecord> standing, gathered;
  std::vector<RecordChange> changes;
  float least_cosine = 0;  ///< smallest cosine between normals for which a record counts (RecordStore)
  std::string history;
};

/// True if the file has the columns influence and update.
bool is_localised(const formats::IrradcacheFile& file);
/// The records of a file that is_localised(), in the frame's space.
LocalisedRecords localised_records(const formats::IrradcacheFile& file, const SceneFrame& frame);
/// Records for a file, with columns and sets filled in.
std::vector<formats::IrradianceCacheRecord> to_file(const LocalisedRecords& cache, const SceneFrame& frame);

}  // namespace tempolux
