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

/// Records of the set static belong to the static scene; changes[i] belongs to standing[i]. Records of the set
/// dynamic were gathered for the frame.
struct LocalisedRecords {
  std::vector<IrradianceRecord> standing, gathered;
  std::vector<RecordChange> changes;
  float least_cosine = 0;  ///< smallest cosine between normals for which a record of either set counts
  std::string history;
};

/// True if the file has the columns influence and update.
bool is_localised(const formats::IrradcacheFile& file);
/// The records of a file, in the frame's space.
LocalisedRecords localised_records(const formats::IrradcacheFile& file, const SceneFrame& frame);
/// Records for a file, with columns and sets filled in.
std::vector<formats::IrradianceCacheRecord> to_file(const LocalisedRecords& cache, const SceneFrame& frame);

}  // namespace tempolux
