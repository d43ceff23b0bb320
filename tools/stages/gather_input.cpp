#include "tools/stages/gather_input.h"

#include <algorithm>
#include <utility>

#include "formats/error.h"
#include "lib/density/split_light.h"
#include "lib/gather/cache_files.h"
#include "lib/material/surface_material.h"

namespace tempolux::tools {
namespace {

/// Refuses a file that lacks light of the scene. `remedy` names the command that makes a complete file.
void check_kinds(Tool& tool, const std::string& file, const std::string& kinds, const std::vector<std::string>& wanted,
                 const SceneFrame& frame, const std::string& remedy) {
  const Lobes lobes = lobes_of(frame);
  if (!lobes.lambert) return;
  for (const std::string& kind : wanted) {
    if (holds_kind(kinds, kind)) continue;
    const std::string lacks = file + ": holds no " + kind + " light (its kinds: " + kinds + ")";
    if (kind != "caustic") throw InputError(lacks + ", which this scene has; " + remedy);
    if (lobes.specular)
      tool.warn(lacks + ", which mirrors, glass and gloss of this scene throw: it is left out; " + remedy);
  }
}

/// Refuses one part of a divided file where the whole is needed: its missing light would be lost silently.
void refuse_part(const std::string& file, const std::string& part) {
  if (!part.empty())
    throw InputError(file + ": holds the " + part +
                     " part of the light alone (photonmap-split); give the whole, or the low part here and the high "
                     "one as --high");
}

void check_photons(Tool& tool, const std::string& file, const formats::PhotonHeader& header, const SceneFrame& frame,
                   const WantedPhotons& wanted) {
  if (header.map != wanted.map)
    throw InputError(file + ": a " + header.map + " map" +
                     (header.map == "global" ? "" : " is a part of the scene's light") + "; give a " + wanted.map +
                     " one, as photon-trace writes it with --map " + wanted.map);
  refuse_part(file, header.part);
  check_identity(tool, file, header.identity, frame);
  std::vector<std::string> kinds{"caustic"};
  if (wanted.needed == LightNeeded::all) kinds.insert(kinds.begin(), "indirect");
  check_kinds(tool, file, header.kinds, kinds, frame, "trace it with --kinds caustic,indirect");
}

/// Throws InputError unless the file is this part of photonmap-split's output. `option`: the option that names it.
void require_part(const std::string& file, const std::string& found, const std::string& part,
                  const std::string& option) {
  if (found == part) return;
  throw InputError(file + ": is " + (found.empty() ? "not a part of light" : "the " + found + " part") + "; give " +
                   option + " the " + part + " part that photonmap-split writes");
}

GatherPoints checked_points(Tool& tool, const std::string& file, const formats::IrradpointsFile& in,
                            const SceneFrame& frame) {
  check_identity(tool, file, in.header.identity, frame);
  check_kinds(tool, file, in.header.kinds, {"direct", "caustic", "indirect"}, frame, "make the points again");
  return {from_file(in.records, shift_of(in.header.origin, frame)), float(in.header.spacing), in.header.kinds,
          in.header.history, in.header.emitted_count};
}

formats::IrradpointsFile load_points(Tool& tool, const std::string& file) {
  tool.depends_on(file);
  return formats::load_irradpoints(file);
}

formats::PhotonMap load_map(Tool& tool, const std::string& file) {
  tool.depends_on(file);
  return formats::load_photons(file);
}

}  // namespace

GatherPoints read_points(Tool& tool, const std::string& file, const SceneFrame& frame) {
  const formats::IrradpointsFile in = load_points(tool, file);
  refuse_part(file, in.header.part);
  return checked_points(tool, file, in, frame);
}

DividedGatherPoints read_divided_points(Tool& tool, const std::string& low_file, const std::string& high_file,
                                        const SceneFrame& frame) {
  if (high_file.empty()) return {read_points(tool, low_file, frame), {}};
  formats::IrradpointsFile low = load_points(tool, low_file);
  require_part(low_file, low.header.part, "low", "--points");
  const formats::IrradpointsFile high = load_points(tool, high_file);
  require_part(high_file, high.header.part, "high", "--high");
  check_identity(tool, high_file, high.header.identity, frame);
  DividedGatherPoints divided;
  divided.high_shares = tempolux::join_parts(low.records, high.records);
  // Points of a surface are a prefix of one sequence, so the files must hold the same points.
  if (divided.high_shares.size() != low.records.size() || low.header.origin != high.header.origin ||
      low.header.spacing != high.header.spacing || low.header.emitted_count != high.header.emitted_count)
    throw InputError(high_file + ": its points are not those of " + low_file + "; give the two parts of one file");
  divided.whole = checked_points(tool, low_file, low, frame);
  return divided;
}

PointsRead::PointsRead(Tool& tool, const Tracer& tracer, const Lights& lights, const DividedGatherPoints& points,
                       GatherOptions& gather)
    : lookup(points.whole.points, points.whole.spacing, point_clearance(tracer)),
      beside_lamps(note_lamps_beside(tracer, lights, lookup)) {
  if (beside_lamps.empty() && !points.any_high()) return;
  bright.emplace(tracer, lights, lookup, points.high_shares,
                 BrightOptions{.seed = gather.seed, .beside_lamps = beside_lamps});
  tool.stats().count("bright_points", double(bright->spot_count()));
  tool.stats().count("bright_sites", double(bright->site_count()));
  gather.bright = &*bright;
}

formats::PhotonMap read_photons(Tool& tool, const std::string& file, const SceneFrame& frame,
                                const WantedPhotons& wanted) {
  tool.depends_on(file);
  formats::PhotonMap map =
      !wanted.keep
          ? formats::load_photons(file)
          : formats::load_photons(file, [&](const formats::PhotonHeader& header, const formats::Photon& photon) {
              return wanted.keep(shifted(photon.position, shift_of(header.origin, frame)), photon);
            });
  check_photons(tool, file, map.header, frame, wanted);
  return map;
}

DividedPhotonMap read_divided_photons(Tool& tool, const std::string& low, const std::string& high,
                                      const SceneFrame& frame, LightNeeded needed) {
  DividedPhotonMap map{load_map(tool, low), {}};
  require_part(low, map.whole.header.part, "low", "--photons");
  map.high = load_map(tool, high);
  require_part(high, map.high.header.part, "high", "--high");
  const formats::PhotonHeader &one = map.whole.header, &other = map.high.header;
  // Both parts must come from one map: the same paths, emitted flux and state of the scene.
  if (one.emitted_count != other.emitted_count || one.origin != other.origin || one.columns != other.columns ||
      one.kinds != other.kinds || one.map != other.map || map.whole.totals.emitted_flux != map.high.totals.emitted_flux)
    throw InputError(high + ": its photons are not those of " + low + "; give the two parts of one file");
  check_identity(tool, high, other.identity, frame);
  join_parts(map.whole, map.high);
  check_photons(tool, low, map.whole.header, frame, {needed});
  return map;
}

formats::PhotonMap read_earlier_change(Tool& tool, const std::string& file, const SceneFrame& frame) {
  formats::PhotonMap map = load_map(tool, file);
  if (map.header.map != "dynamic") throw InputError(file + ": a " + map.header.map + " map; give a dynamic one");
  formats::Identity identity = map.header.identity;
  identity.moving_geometry.clear(), identity.lights.clear(), identity.materials.clear();
  check_identity(tool, file, identity, frame);
  return map;
}

void write_points(Tool& tool, const GatherPoints& points, const SceneFrame& frame, Output& output,
                  std::optional<std::array<int, 2>> frames) {
  formats::IrradpointsHeader header;
  header.history = points.history + tool.history_line(frame.frame);
  header.identity = identity_of(frame);
  if (frames) header.identity.first_frame = (*frames)[0], header.identity.last_frame = (*frames)[1];
  header.origin = array_of(frame.origin);
  header.spacing = double(points.spacing);
  header.emitted_count = points.emitted_count;
  header.kinds = points.kinds;
  header.columns = formats::column_points_noise;
  formats::IrradpointsWriter writer(output.sink(), header);
  writer.write(to_file(points.points, frame));
  writer.finish();
  output.commit();
}

formats::IrradcacheHeader records_header(const SceneFrame& frame, std::span<const IrradianceRecord> records,
                                         float least_cosine, const GatherOptions& gather,
                                         const PlacementOptions& placement) {
  formats::IrradcacheHeader header;
  header.identity = identity_of(frame);
  header.origin = array_of(frame.origin);
  header.columns = formats::column_clearance;
  header.rays = std::uint32_t(gather.rays);
  header.error_bound = double(placement.error_bound);
  header.least_cosine = double(least_cosine);
  if (!records.empty()) {
    const auto [least, most] = std::ranges::minmax_element(records, {}, &IrradianceRecord::radius);
    header.min_radius = double(least->radius), header.max_radius = double(most->radius);
  }
  return header;
}

void write_records(const formats::IrradcacheHeader& header, const std::vector<formats::IrradianceCacheRecord>& records,
                   Output& output) {
  formats::IrradcacheWriter writer(output.sink(), header);
  writer.write(records);
  writer.finish();
  output.commit();
}

std::string add_records(Tool& tool, const std::string& name, const formats::IrradcacheFile& file,
                        const SceneFrame& frame, RecordStore& store) {
  if (file.header.columns & (formats::column_influence | formats::column_update))
    throw InputError(name +
                     ": holds records that stand beside those of a frame (--update); give one without these columns");
  check_identity(tool, name, file.header.identity, frame);
  store.add(from_file(file.records, shift_of(file.header.origin, frame)));
  return file.header.history;
}

}  // namespace tempolux::tools
