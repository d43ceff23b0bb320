// tools/stages/trace_photons.h -- photon-trace: writes the photon map of a frame: global, static or dynamic.
#pragma once

#include <cstdint>
#include <string>

#include "formats/paths/paths.h"
#include "tools/common/scene_input.h"
#include "tools/stages/importance.h"
#include "tools/stages/update_photons.h"

namespace tempolux::tools {

struct TraceOptions {
  std::string scene, output, kinds = "direct,caustic,indirect", map = "global", importance;
  std::uint64_t photons = 1'000'000;  ///< light paths
  std::string paths;                  ///< --map static: file of touched paths to write; "": none
  std::string static_paths;           ///< --map dynamic: file of touched paths to read
  UpdateArguments updating;
};

/// Traces frames of one scene, one after the other.
class PhotonTracing {
 public:
  PhotonTracing(Tool& tool, SceneInput& input, const TraceOptions& options)
      : tool_(tool), input_(input), options_(options), importance_(tool, input, options.importance, options.kinds) {}

  /// Writes the map that options.map names. `is_last`: no further frame follows.
  void trace(int frame_number, bool is_last);

 private:
  void trace_global(int frame_number);
  void trace_static(int frame_number);
  void trace_dynamic(int frame_number);

  EmissionTable aimed_emission(const SceneFrame& frame, int frame_number);
  PhotonOptions photon_options(int frame_number) const;
  formats::PhotonHeader header_of(const SceneFrame& frame, const EmissionTable& emission, int frame_number) const;
  void finish(Output* output, const PhotonMapResult& result, std::uint64_t refused_rays);
  void warn_of_few(const Lights& lights, const PhotonMapResult& result, int frame_number);
  void check_paths(const std::string& file, const formats::PathsHeader& paths, const SceneFrame& static_frame,
                   const std::string& emission, int frame);

  Tool& tool_;
  SceneInput& input_;
  const TraceOptions& options_;
  Importance importance_;
  StaticTree static_tree_;
  KeptMap kept_;
};

}  // namespace tempolux::tools
