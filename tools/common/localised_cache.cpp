#include "tools/common/localised_cache.h"

#include <CLI/CLI.hpp>

#include "formats/error.h"
#include "lib/gather/cache_files.h"
#include "tools/common/option_words.h"

namespace tempolux::tools {
namespace {

constexpr std::uint32_t kColumns = formats::column_influence | formats::column_update;

}  // namespace

bool is_localised(const formats::IrradcacheFile& file) { return (file.header.columns & kColumns) == kColumns; }

LocalisedRecords localised_records(const formats::IrradcacheFile& file, const SceneFrame& frame) {
  const std::array<double, 3>& origin = file.header.origin;
  const std::vector<IrradianceRecord> records =
      from_file(file.records, Vec3d{origin[0], origin[1], origin[2]} - frame.origin);
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
    cache.changes.push_back({Rgb(record.update[0], record.update[1], record.update[2]), record.influence});
  }
  return cache;
}

std::vector<formats::IrradianceCacheRecord> to_file(const LocalisedRecords& cache, const SceneFrame& frame) {
  std::vector<formats::IrradianceCacheRecord> records = tempolux::to_file(cache.standing, frame);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const RecordChange& change = cache.changes[i];
    records[i].set = formats::SurfaceSet::static_set;
    records[i].influence = change.influence;
    records[i].update = {change.update.r, change.update.g, change.update.b};
  }
  for (formats::IrradianceCacheRecord& record : tempolux::to_file(cache.gathered, frame)) {
    record.set = formats::SurfaceSet::dynamic_set;
    records.push_back(record);
  }
  return records;
}

void influence_options(Tool& tool, InfluenceThresholds& thresholds) {
  CLI::App& app = tool.app();
  app.add_option("--influence-low", thresholds.low,
                 "up to this influence of what moves, a share of the static irradiance, indirect light is that of records that "
                 "stand, updated by dynamic photons")
      ->capture_default_str()->check(number_between(0));
  app.add_option("--influence-high", thresholds.high, "from this influence on it is gathered anew; blended in between")
      ->capture_default_str()->check(number_above(0));
  app.add_flag("--influence-absolute", thresholds.absolute, "thresholds are irradiance, W/m^2, not shares of it");
}

void check_influence(const InfluenceThresholds& thresholds) {
  if (!(thresholds.low < thresholds.high)) throw InputError("--influence-low must be below --influence-high");
}

}  // namespace tempolux::tools
