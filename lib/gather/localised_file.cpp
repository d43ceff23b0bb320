#include "lib/gather/localised_file.h"

#include "lib/gather/cache_files.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kColumns = formats::column_influence | formats::column_update;

}  // namespace

bool is_localised(const formats::IrradcacheFile& file) { return (file.header.columns & kColumns) == kColumns; }

LocalisedRecords localised_records(const formats::IrradcacheFile& file, const SceneFrame& frame) {
  const std::vector<IrradianceRecord> records = from_file(file.records, vec_of(file.header.origin) - frame.origin);
  LocalisedRecords cache;
  cache.least_cosine = float(file.header.least_cosine);
  cache.history = file.header.history;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const formats::IrradianceCacheRecord& record = file.records[i];
    if (record.set == formats::SurfaceSet::dynamic_set) {
      cache.gathered.push_back(records[i]);
      continue;
    }
    cache.standing.push_back(records[i]);
    cache.changes.push_back({rgb_of(record.update), record.influence});
  }
  return cache;
}

std::vector<formats::IrradianceCacheRecord> to_file(const LocalisedRecords& cache, const SceneFrame& frame) {
  std::vector<formats::IrradianceCacheRecord> records = to_file(cache.standing, frame);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const RecordChange& change = cache.changes[i];
    records[i].set = formats::SurfaceSet::static_set;
    records[i].influence = change.influence;
    records[i].update = array_of(change.updated_irradiance);
  }
  for (formats::IrradianceCacheRecord& record : to_file(cache.gathered, frame)) {
    record.set = formats::SurfaceSet::dynamic_set;
    records.push_back(record);
  }
  return records;
}

}  // namespace tempolux
