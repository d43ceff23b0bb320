// tools/info/info_photons.cpp -- tempolux-info on .photons: facts, export.
#include <array>
#include <iterator>
#include <map>
#include <string>

#include "formats/photons/summary.h"
#include "lib/core/json.h"
#include "lib/image/statistics.h"
#include "tools/info/info_facts.h"
#include "tools/info/point_table.h"

namespace tempolux::tools {
namespace {

using namespace formats;

constexpr const char* kKindNames[] = {"direct", "caustic", "indirect", "volume", "tentative"};

/// The header without history and identity.
Facts header_facts(const PhotonHeader& header) {
  Facts facts = {{"map", header.map},
                 {"kinds", header.kinds},
                 {"columns", column_names({{header.columns & column_direction, "direction"},
                                           {header.columns & column_albedo, "albedo"}})},
                 {"origin_m", header.origin},
                 {"groups", header.group_count},
                 {"emitted_paths", header.emitted_count}};
  if (!header.part.empty()) facts["part"] = header.part;
  if (header.pilots > 0) facts["pilots_of_a_group"] = header.pilots;
  if (!header.base_name.empty()) {
    facts["overlay_of"] = header.base_name;
    facts["base_digest"] = header.base_digest;
  }
  return facts;
}

Facts share_facts(const PhotonShare& share) { return {{"photons", share.count}, {"flux_W", share.flux}}; }

Facts kind_facts(const PhotonSummary& summary) {
  Facts facts = Facts::object();
  for (std::size_t kind = 0; kind < summary.by_kind.size(); ++kind)
    if (summary.by_kind[kind].count > 0) facts[kKindNames[kind]] = share_facts(summary.by_kind[kind]);
  return facts;
}

Facts total_facts(const PhotonTotals& totals) {
  return {{"emitted_flux_W", totals.emitted_flux},
          {"stored_flux_W", totals.stored_flux},
          {"escaped_flux_W", totals.escaped_flux},
          {"absorbed_flux_W", totals.absorbed_flux}};
}

/// Age of the groups: for each frame at which groups were traced, their number and paths.
Facts group_facts(const std::vector<GroupFlux>& ledger) {
  std::map<std::int32_t, std::pair<std::uint64_t, std::uint64_t>> by_frame;
  for (const GroupFlux& group : ledger) {
    ++by_frame[group.frame].first;
    by_frame[group.frame].second += group.paths;
  }
  Facts facts = Facts::array();
  for (const auto& [frame, count] : by_frame)
    facts.push_back({{"frame", frame}, {"groups", count.first}, {"paths", count.second}});
  return facts;
}

}  // namespace

Facts photon_facts(const std::string& path) {
  PhotonReader reader(path);
  const PhotonSummary summary = summarise(reader);
  const PhotonTotals& totals = reader.totals();
  Facts facts = start_of(path, "photons", reader.header().history, reader.header().identity);
  facts.update(header_facts(reader.header()));
  facts["photons"] = totals.photon_count;
  if (summary.all.count > 0) {
    facts["bounds_m"] = {{"min", summary.bounds_min}, {"max", summary.bounds_max}};
    facts["mean_flux_W"] = summary.mean_flux;
    facts["largest_flux_W"] = summary.largest_flux;
    facts["largest_bounce"] = summary.largest_bounce;
  }
  facts.update(total_facts(totals));
  facts["by_kind"] = kind_facts(summary);
  if (!reader.header().majorants.empty()) facts["groups_traced_at"] = group_facts(reader.ledger());
  facts["by_object"] = Facts::array();
  for (const auto& [object, share] : summary.by_object) {
    Facts line = {{"object", object}};
    line.update(share_facts(share));
    facts["by_object"].push_back(line);
  }
  facts["digest"] = reader.digest();
  return facts;
}

void export_photons(const std::string& path, const std::string& format, Output& output) {
  double white = 0;
  std::uint64_t count = 0;
  if (format == "ply") {  // PLY needs the count and the brightest photon first, so the file is read twice
    if (path == "-") throw InputError("-: PLY reads its input twice; save the stream to a file first");
    PhotonReader first(path, {.digest = false});
    const PhotonSummary summary = summarise(first);
    white = summary.largest_flux, count = summary.all.count;
  }
  PhotonReader reader(path, {.digest = false});
  const std::array<double, 3> origin = reader.header().origin;
  const bool directions = format == "csv" && reader.header().columns & column_direction,
             albedos = format == "csv" && reader.header().columns & column_albedo;
  std::vector<PointTable::Column> columns{PointTable::channels("flux", "W"),
                                          {{"object"}, "", "ushort"},
                                          {{"kind"}, "", "uchar", {std::begin(kKindNames), std::end(kKindNames)}},
                                          {{"bounce"}, "", "uchar"}};
  if (directions) columns.push_back({{"wi_x", "wi_y", "wi_z"}, ""});
  if (albedos) columns.push_back(PointTable::channels("albedo", ""));
  PointTable table(format, output, count, "photons; flux in W, positions in m", columns);
  PhotonBlock block;
  while (reader.read_block(block))
    for (std::size_t i = 0; i < block.photons.size(); ++i) {
      const Photon& photon = block.photons[i];
      for (std::size_t c = 0; c < 3; ++c) table.add(origin[c] + double(photon.position[c]));
      table.add(decode_normal(photon.normal));
      table.add(photon.flux);
      table.add(photon.object);
      table.add(double(photon.kind));
      table.add(photon.bounce);
      if (directions) table.add(decode_normal(block.directions[i]));
      for (std::size_t c = 0; albedos && c < 3; ++c) table.add(block.albedos[i][c] / 255.0);
      table.end_row(point_color(photon.flux, white));
    }
  table.finish();
}

}  // namespace tempolux::tools
