// tools/stages/gather_input.h -- reads and writes irradiance points and records for tools that gather.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/irradcache/irradcache.h"
#include "formats/photons/photons.h"
#include "lib/gather/bright_points.h"
#include "lib/points/gather_points.h"
#include "lib/gather/place_records.h"
#include "lib/irradcache/records.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// Which light a reader needs from photons or points.
enum class LightNeeded { all, caustic };

/// The photons that a reader needs from a map.
struct WantedPhotons {
  LightNeeded needed = LightNeeded::all;
  std::string map = "global";  ///< kind of the map
  /// Photons for which this returns false are left out; the position is in scene space. Empty: all are kept.
  std::function<bool(Vec3, const formats::Photon&)> keep = {};
};

/// Reads the photons of a map that was made for this state of the scene (else InputError, see check_identity). For a
/// static map `frame` is the static scene. The map must hold the kinds of light that the scene's surfaces need: without
/// indirect light it is refused, without caustic light there is a warning.
formats::PhotonMap read_photons(Tool& tool, const std::string& file, const SceneFrame& frame,
                                const WantedPhotons& wanted);

/// Reads the two parts from photonmap-split, checked as read_photons checks a map. Throws InputError if the files are
/// not the two parts of one map.
DividedPhotonMap read_divided_photons(Tool& tool, const std::string& low, const std::string& high,
                                      const SceneFrame& frame, LightNeeded needed);

/// Reads the dynamic map of another frame of the segment: the static scene must be the same, movers may differ.
formats::PhotonMap read_earlier_change(Tool& tool, const std::string& file, const SceneFrame& frame);

/// Reads a .irradpoints file made for this state of the scene; checks its kinds of light as read_photons does.
GatherPoints read_points(Tool& tool, const std::string& file, const SceneFrame& frame);
/// Reads the two parts of divided points, checked as read_points checks a file. Throws InputError if the files are not
/// the two parts of one file. If `high` is "", the file `low` holds all light, and there are no shares.
DividedGatherPoints read_divided_points(Tool& tool, const std::string& low, const std::string& high,
                                        const SceneFrame& frame);
/// Points prepared for gather rays, and the light that records sample explicitly: light of lamps close to surfaces, and
/// of points with a high share (photonmap-split). All arguments must outlive this object.
struct PointsRead {
  PointLookup lookup;
  std::vector<LampPhoton> beside_lamps;
  std::optional<BrightPoints> bright;  ///< empty: no light is sampled explicitly; else `gather` points to it

  PointsRead(Tool& tool, const Tracer& tracer, const Lights& lights, const DividedGatherPoints& points,
             GatherOptions& gather);
};

/// Writes points that are valid for the frame, or for the given first to last frame; adds counts to stats.
void write_points(Tool& tool, const GatherPoints& points, const SceneFrame& frame, Output& output,
                  std::optional<std::array<int, 2>> frames = {});

/// Header of a cache of a frame's records; placed_frames and history are left to the caller.
formats::IrradcacheHeader records_header(const SceneFrame& frame, std::span<const IrradianceRecord> records,
                                         float least_cosine, const GatherOptions& gather,
                                         const PlacementOptions& placement);
void write_records(const formats::IrradcacheHeader& header, const std::vector<formats::IrradianceCacheRecord>& records,
                   Output& output);

/// Adds the records of a loaded file, made for this state of the scene, to a store; returns the file's history. Throws
/// InputError for a localised cache, whose records are of several kinds.
std::string add_records(Tool& tool, const std::string& name, const formats::IrradcacheFile& file,
                        const SceneFrame& frame, RecordStore& store);

}  // namespace tempolux::tools
