// tools/info/info_photons.cpp -- tempolux-info on .photons: facts, export.
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/photons/summary.h"
#include "lib/image/statistics.h"
#include "tools/info/info_facts.h"

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

std::string ply_header(std::uint64_t count) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment photons; flux in W, positions in m\n";
  text += "element vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z"}) text += std::string("property double ") + name + "\n";
  for (const char* name : {"nx", "ny", "nz", "flux_r", "flux_g", "flux_b"})
    text += std::string("property float ") + name + "\n";
  text += "property ushort object\n";
  for (const char* name : {"kind", "bounce", "red", "green", "blue"})
    text += std::string("property uchar ") + name + "\n";
  return text + "end_header\n";
}

/// Appends one vertex in the layout of the PLY header above, little-endian.
void append_vertex(std::string& to, const std::array<double, 3>& position, const Photon& photon, double white) {
  static_assert(std::endian::native == std::endian::little);
  const auto put = [&to](const auto& value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    to.append(bytes, sizeof value);
  };
  put(position);
  put(decode_normal(photon.normal));
  put(photon.flux);
  put(photon.object);
  put(photon.kind);
  put(photon.bounce);
  put(point_color(photon.flux, white));
}

/// Appends a photon of a block with the file's columns.
void append_row(std::string& to, const std::array<double, 3>& position, const PhotonBlock& block, std::size_t i,
                std::uint32_t columns) {
  const Photon& photon = block.photons[i];
  const auto normal = decode_normal(photon.normal);
  char text[400];
  const int length = std::snprintf(
      text, sizeof text, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.6g,%.6g,%.6g,%u,%s,%u", position[0], position[1], position[2],
      double(photon.flux[0]), double(photon.flux[1]), double(photon.flux[2]), double(normal[0]), double(normal[1]),
      double(normal[2]), unsigned(photon.object), kKindNames[std::size_t(photon.kind)], unsigned(photon.bounce));
  to.append(text, std::size_t(length));
  const auto add = [&](double value) {
    to.append(text, std::size_t(std::snprintf(text, sizeof text, ",%.6g", value)));
  };
  if (columns & column_direction)
    for (const float w : decode_normal(block.directions[i])) add(double(w));
  if (columns & column_albedo)
    for (std::size_t c = 0; c < 3; ++c) add(block.albedos[i][c] / 255.0);
  to += '\n';
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
  const bool ply = format == "ply";
  double white = 0;
  std::string text;
  if (ply) {  // PLY needs the count and the brightest photon first, so the file is read twice
    if (path == "-") throw InputError("-: PLY reads its input twice; save the stream to a file first");
    PhotonReader first(path, {.digest = false});
    const PhotonSummary summary = summarise(first);
    white = summary.largest_flux;
    text = ply_header(summary.all.count);
  }
  PhotonReader reader(path, {.digest = false});
  const std::array<double, 3> origin = reader.header().origin;
  const std::uint32_t columns = reader.header().columns;
  if (!ply)
    text = std::string("x_m,y_m,z_m,flux_r_W,flux_g_W,flux_b_W,nx,ny,nz,object,kind,bounce") +
           (columns & column_direction ? ",wi_x,wi_y,wi_z" : "") +
           (columns & column_albedo ? ",albedo_r,albedo_g,albedo_b" : "") + "\n";
  PhotonBlock block;
  while (reader.read_block(block)) {
    for (std::size_t i = 0; i < block.photons.size(); ++i) {
      const Photon& photon = block.photons[i];
      std::array<double, 3> position = origin;
      for (std::size_t c = 0; c < 3; ++c) position[c] += double(photon.position[c]);
      if (ply) append_vertex(text, position, photon, white);
      else append_row(text, position, block, i, columns);
    }
    output.write(text.data(), text.size());
    text.clear();
  }
  output.write(text.data(), text.size());
}

}  // namespace tempolux::tools
