// tools/info/info_records.cpp -- tempolux-info on .irradpoints and .irradcache: facts, export.
#include <algorithm>
#include <array>
#include <string>

#include "formats/irradcache/summary.h"
#include "formats/irradpoints/summary.h"
#include "lib/core/json.h"
#include "lib/image/statistics.h"
#include "tools/info/info_facts.h"
#include "tools/info/point_table.h"

namespace tempolux::tools {
namespace {

using namespace formats;

Facts channel_facts(const std::array<Spread, 3>& channels) {
  Facts facts = {{"min", Facts::array()}, {"max", Facts::array()}, {"mean", Facts::array()}};
  for (const Spread& channel : channels) {
    if (channel.count == 0) return nullptr;
    facts["min"].push_back(channel.min);
    facts["max"].push_back(channel.max);
    facts["mean"].push_back(channel.mean());
  }
  return facts;
}

void add_census(const RecordCensus& census, const char* what, Facts& facts) {
  facts["by_set"] = {{"static", census.by_set[0]}, {"dynamic", census.by_set[1]}};
  if (census.count > 0)
    facts["bounds_m"] = {{"min", {census.position[0].min, census.position[1].min, census.position[2].min}},
                         {"max", {census.position[0].max, census.position[1].max, census.position[2].max}}};
  facts["by_object"] = Facts::array();
  for (const auto& [object, count] : census.by_object)
    facts["by_object"].push_back({{"object", object}, {what, count}});
}

Facts header_facts(const IrradpointsHeader& header) {
  Facts facts = {{"kinds", header.kinds},
                 {"origin_m", header.origin},
                 {"spacing_m", header.spacing},
                 {"emitted_paths", header.emitted_count}};
  if (header.columns & column_points_noise) facts["columns"] = "noise";
  if (!header.part.empty()) facts["part"] = header.part;
  return facts;
}

Facts header_facts(const IrradcacheHeader& header) {
  return {{"columns", column_names({{header.columns & column_influence, "influence"},
                                    {header.columns & column_update, "update"},
                                    {header.columns & column_clearance, "clearance"},
                                    {header.columns & column_noise, "noise"}})},
          {"origin_m", header.origin},
          {"rays", header.rays},
          {"error_bound", header.error_bound},
          {"least_cosine", header.least_cosine},
          {"lamps_apart_m", header.lamps_apart},
          {"radius_limits_m", {header.min_radius, header.max_radius}},
          {"placed_frames", header.placed_frames}};
}

Facts total_facts(const IrradpointsTotals& totals) {
  return {{"points", totals.point_count},
          {"direct_sum_W_m2", totals.direct},
          {"caustic_sum_W_m2", totals.caustic},
          {"indirect_sum_W_m2", totals.indirect}};
}

Facts total_facts(const IrradcacheTotals& totals) {
  return {{"records", totals.record_count}, {"irradiance_sum_W_m2", totals.irradiance}};
}

template <class File>
Facts file_facts(const std::string& path, const char* type, const File& file) {
  Facts facts = start_of(path, type, file.header.history, file.header.identity);
  facts.update(header_facts(file.header));
  facts.update(total_facts(file.totals));
  return facts;
}

const PointTable::Column kObjectColumn{{"object"}, "", "ushort"},
    kSetColumn{{"set"}, "", "uchar", {"static", "dynamic"}};

/// Adds the first columns of every row: position in world space, and normal.
template <class Record, class Normal>
void start_row(PointTable& table, const std::array<double, 3>& origin, const Record& record, const Normal& normal) {
  for (std::size_t c = 0; c < 3; ++c) table.add(origin[c] + double(record.position[c]));
  table.add(normal);
}

/// Adds the last columns of every row: object, surface set, and colour.
template <class Record>
void end_row(PointTable& table, const Record& record, const std::array<float, 3>& irradiance, double white) {
  table.add(record.object);
  table.add(double(record.set));
  table.end_row(point_color(irradiance, white));
}

double largest(const std::array<float, 3>& irradiance) {
  return double(std::max({irradiance[0], irradiance[1], irradiance[2]}));
}

std::array<float, 3> all_kinds(const IrradiancePointRecord& point) {
  std::array<float, 3> sum{};
  for (std::size_t c = 0; c < 3; ++c) sum[c] = point.direct[c] + point.caustic[c] + point.indirect[c];
  return sum;
}

}  // namespace

Facts irradpoints_facts(const std::string& path) {
  const IrradpointsFile file = load_irradpoints(path);
  const IrradpointsSummary summary = summarise(file);
  Facts facts = file_facts(path, "irradpoints", file);
  const auto add_kind = [&](const char* name, const IrradianceShare& share) {
    if (("," + file.header.kinds + ",").find(std::string(",") + name + ",") == std::string::npos) return;
    facts["by_kind"][name] = {{"irradiance_W_m2", channel_facts(share.irradiance)}, {"flux_W", share.flux}};
  };
  facts["by_kind"] = Facts::object();
  add_kind("direct", summary.direct);
  add_kind("caustic", summary.caustic);
  add_kind("indirect", summary.indirect);
  facts["radius_m"] = spread_facts(summary.radius);
  add_census(summary.points, "points", facts);
  facts["digest"] = digest_of(file);
  return facts;
}

Facts irradcache_facts(const std::string& path) {
  const IrradcacheFile file = load_irradcache(path);
  const IrradcacheSummary summary = summarise(file);
  Facts facts = file_facts(path, "irradcache", file);
  facts["irradiance_W_m2"] = channel_facts(summary.irradiance);
  facts["radius_m"] = spread_facts(summary.radius);
  facts["radius_unclamped_m"] = spread_facts(summary.radius_unclamped);
  if (file.header.columns & column_influence) facts["influence_W_m2"] = spread_facts(summary.influence);
  add_census(summary.records, "records", facts);
  facts["digest"] = digest_of(file);
  return facts;
}

void export_irradpoints(const std::string& path, const std::string& format, Output& output) {
  const IrradpointsFile file = load_irradpoints(path);
  double white = 0;
  for (const IrradiancePointRecord& point : file.records) white = std::max(white, largest(all_kinds(point)));
  const bool noise = format == "csv" && file.header.columns & column_points_noise;
  std::vector<PointTable::Column> columns;
  for (const char* kind : {"direct", "caustic", "indirect"}) columns.push_back(PointTable::channels(kind, "W_m2"));
  columns.push_back({{"radius"}, "m"});
  if (noise) columns.push_back(PointTable::channels("noise", "W_m2"));
  columns.insert(columns.end(), {kObjectColumn, kSetColumn});
  PointTable table(format, output, file.records.size(), "irradiance points; irradiance in W/m^2, positions in m",
                   columns);
  for (const IrradiancePointRecord& point : file.records) {
    start_row(table, file.header.origin, point, decode_normal(point.normal));
    for (const auto* irradiance : {&point.direct, &point.caustic, &point.indirect}) table.add(*irradiance);
    table.add(double(point.radius));
    if (noise) table.add(point.noise);
    end_row(table, point, all_kinds(point), white);
  }
  table.finish();
}

void export_irradcache(const std::string& path, const std::string& format, Output& output) {
  const IrradcacheFile file = load_irradcache(path);
  double white = 0;
  for (const IrradianceCacheRecord& record : file.records) white = std::max(white, largest(record.irradiance));
  std::vector<PointTable::Column> columns{
      PointTable::channels("irradiance", "W_m2"), {{"radius"}, "m"}, {{"radius_unclamped"}, "m"}};
  const bool csv = format == "csv";
  const auto has = [&](std::uint32_t column) { return csv && file.header.columns & column; };
  if (csv)
    for (const auto& [gradient, unit] : {std::pair{"rotational", "W_m2"}, {"translational", "W_m3"}})
      for (const std::string channel : {"_r", "_g", "_b"})
        columns.push_back({{gradient + channel + "_x", gradient + channel + "_y", gradient + channel + "_z"}, unit});
  if (has(column_influence)) columns.push_back({{"influence"}, "W_m2"});
  if (has(column_update)) columns.push_back(PointTable::channels("update", "W_m2"));
  if (has(column_clearance))
    for (int k = 0; k < 16; ++k) columns.push_back({{"clearance_" + std::to_string(k)}, "m"});
  if (has(column_noise)) columns.push_back(PointTable::channels("noise", "W_m2"));
  columns.insert(columns.end(), {kObjectColumn, kSetColumn});
  PointTable table(format, output, file.records.size(), "irradiance records; irradiance in W/m^2, positions in m",
                   columns);
  for (const IrradianceCacheRecord& record : file.records) {
    start_row(table, file.header.origin, record, record.normal);
    table.add(record.irradiance);
    table.add(double(record.radius));
    table.add(double(record.radius_unclamped));
    if (csv)
      for (const auto* gradients : {&record.rotational, &record.translational})
        for (const auto& channel : *gradients) table.add(channel);
    if (has(column_influence)) table.add(double(record.influence));
    if (has(column_update)) table.add(record.update);
    if (has(column_clearance))
      for (std::size_t k = 0; k < 16; ++k)
        table.add(double(record.clearance_reach) * double(record.clearance[k]) / 255);
    if (has(column_noise)) table.add(record.noise);
    end_row(table, record, record.irradiance, white);
  }
  table.finish();
}

}  // namespace tempolux::tools
