// lib/pilot/photon_shares.h -- the share of the photons that each light gets, and the openings at which photons of sun
// and sky are aimed, by what photons bring into view.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "formats/plan/view.h"
#include "lib/light/lights.h"
#include "lib/pilot/find_openings.h"
#include "lib/pilot/seen_spheres.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Measures how the photons of a map are best shared out among the lights (docs/methods/aim.md, "Shares of lights").
/// Lights of one node share their part by flux.
///
/// A pilot traces few paths of every light. Cell k holds the share c_k of what cameras see. Photons count in the cell
/// if a seen place of the cell looks at them. Let E_k be their flux, and s_ik^2 the mean over the paths of light i,
/// which carry the light's whole flux, of their squared flux in the cell. N paths with the shares p_i estimate the
/// light of the cells with the mean relative variance
///     V = (1 / N) sum_k c_k sum_i s_ik^2 / (p_i E_k^2).
/// V is least if p_i is in proportion to the root of sum_k c_k s_ik^2 / E_k^2.
class SharePilot {
 public:
  /// cells: seen_spheres() of the places. kinds: of the map's photons, as for PhotonOptions::set_kinds.
  SharePilot(std::vector<formats::ViewSphere> cells, std::span<const WeighedPlace> places, std::string kinds);

  /// Adds the pilot of a frame. The table belongs to the frame's segment and has aim if the map's photons are aimed. No
  /// work with a single light, unless it is sun or sky. The same result for any number of threads.
  void look(const Tracer& tracer, const EmissionTable& table);

  /// Shares by node. Empty if fewer than two lights matter, or if V is less than kLeastGain times better than with the
  /// shares of the last table.
  std::vector<formats::ViewLight> shares() const;
  /// find_openings() of all frames. x^2 of a path is the sum over its photons of c_k (flux / E_k)^2.
  std::vector<formats::ViewSphere> openings() const;

 private:
  std::vector<formats::ViewSphere> cells_;
  std::vector<std::vector<WeighedPlace>> places_;  ///< of each cell
  std::string kinds_;
  std::map<std::uint32_t, double> squares_;  ///< by node: sum over frames and cells of c_k s_ik^2 / E_k^2
  std::map<std::uint32_t, double> before_;   ///< by node: its share in the last table
  std::vector<DistantStart> starts_;         ///< of paths of sun and sky that brought photons into cells
  EmissionTable table_;                      ///< the last one
  Vec3d origin_;                             ///< m, of the last frame
};

/// True if two nodes of the frame, or a node and the environment, may emit photons, so that shares matter.
bool has_several_lights(const SceneFrame& frame, const EmissionTable& table);

/// Gives the lights of each node their share of the photons. kUnguidedShare of the photons stay shared out as in the
/// table, for light that the pilot cannot know. Lights that are not listed get photons from this part only. Nothing
/// changes without shares, or if none of the listed lights ever shines in the table's segment.
void give_shares(const SceneFrame& frame, std::span<const formats::ViewLight> shares, EmissionTable& table);

}  // namespace tempolux
