// tools/stages/gather_input.h -- irradiance points and records for the tools that gather: read, made, written.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/irradcache/irradcache.h"
#include "formats/photons/photons.h"
#include "lib/gather/gather_points.h"
#include "lib/irradcache/records.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// What a reader of photons or points takes from them.
enum class LightNeeded { all, caustic };

/// Reads the photons of a whole map (or of that part of the scene's light that `map` names: of a static map `frame` is
/// the standing scene) made for this state of the scene (InputError otherwise, see check_identity). It must hold the
/// kinds that the scene's surfaces call for: without indirect light it is refused, without caustic light there is a
/// warning.
formats::PhotonMap read_photons(Tool& tool, const std::string& file, const SceneFrame& frame, LightNeeded needed,
                                const std::string& map = "global");
/// The same with those photons only that `keep` takes, told by place (scene space) and photon.
formats::PhotonMap read_photons(Tool& tool, const std::string& file, const SceneFrame& frame, LightNeeded needed,
                                const std::string& map, const std::function<bool(Vec3, const formats::Photon&)>& keep);

/// The two parts of photonmap-split, checked as read_photons checks the whole. InputError if the files are not the two
/// parts of one map.
DividedPhotonMap read_divided_photons(Tool& tool, const std::string& low, const std::string& high,
                                      const SceneFrame& frame, LightNeeded needed);

/// The dynamic map of another frame of the same segment: what stands must be the same, what moves not.
formats::PhotonMap read_earlier_change(Tool& tool, const std::string& file, const SceneFrame& frame);

/// Reads a .irradpoints file made for this state of the scene, with the kinds of light it has: as read_photons.
GatherPoints read_points(Tool& tool, const std::string& file, const SceneFrame& frame);
/// Reads the two parts: as read_points; InputError if they are not those of one file.
DividedGatherPoints read_divided_points(Tool& tool, const std::string& low, const std::string& high,
                                        const SceneFrame& frame);
/// Writes them, valid for the frame or for these frames, first and last; counts go to the statistics.
void write_points(Tool& tool, const GatherPoints& points, const SceneFrame& frame, Output& output,
                  std::optional<std::array<int, 2>> frames = {});

/// Adds the records of a file that was read, made for this state of the scene; returns its history. InputError for one
/// of localised gathering, whose records are not of one kind.
std::string add_records(Tool& tool, const std::string& name, const formats::IrradcacheFile& file,
                        const SceneFrame& frame, RecordStore& store);
/// Adds the records of a .irradcache file to a store; returns the file's history.
std::string read_records(Tool& tool, const std::string& file, InputRole role, const SceneFrame& frame,
                         RecordStore& store);

}  // namespace tempolux::tools
