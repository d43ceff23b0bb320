// lib/plan/stages.h -- the table of the pipeline's stages, which the plan, its cost estimate and the manuals read.
#pragma once

#include <array>
#include <string_view>

#include "lib/plan/decisions.h"

namespace tempolux {

/// A stage makes one kind of file; pipelines/stages.mk has a rule for each.
struct StageInfo {
  std::string_view name;       ///< as in plan.json
  std::string_view folder;     ///< in OUT, holds its files
  std::string_view extension;  ///< extension of the file that later stages read
  std::string_view tool;       ///< the program that runs
  /// Phases of its statistics whose time grows with the work, separated by commas.
  std::string_view work;
};

namespace stage {
inline constexpr StageInfo photons{"photon-trace", "photons", ".photons", "photon-trace", "trace,commit"};
inline constexpr StageInfo static_photons{"photon-trace --map static", "stands", ".photons", "photon-trace",
                                          "trace,commit"};
inline constexpr StageInfo moved_photons{"photon-trace --map dynamic", "moved", ".photons", "photon-trace",
                                         "trace,commit"};
inline constexpr StageInfo refined{"photon-trace --refine", "refined", ".photons", "photon-trace", "trace,commit"};
inline constexpr StageInfo points{"irradcache-build points", "points", ".irradpoints", "irradcache-build",
                                  "read photons,points,write"};
inline constexpr StageInfo static_points{"irradcache-build points --map static", "stands_points", ".irradpoints",
                                         "irradcache-build", "read photons,points,write"};
inline constexpr StageInfo split{"photonmap-split", "split", ".low.irradpoints", "photonmap-split", "split"};
inline constexpr StageInfo records{"irradcache-build records", "cache", ".irradcache", "irradcache-build", "records"};
inline constexpr StageInfo static_records{"irradcache-build records --map static", "stands_cache", ".irradcache",
                                          "irradcache-build", "records"};
inline constexpr StageInfo kept{"gather-temporal final", "kept", ".irradcache", "gather-temporal", "records"};
inline constexpr StageInfo counts{"st-filter mesh --counts", "counts", ".meshirrad", "st-filter", "count,write"};
inline constexpr StageInfo windows{"gather-temporal density", "windows", ".meshirrad", "gather-temporal",
                                   "read counts,windows,filter,write"};
inline constexpr StageInfo raw{"frame-render (raw)", "raw", ".exr", "frame-render", "render,data channels,write"};
inline constexpr StageInfo keys{"frame-render (keys)", "keys", ".exr", "frame-render", "render,data channels,write"};
inline constexpr StageInfo pictures{"frame-render", "pictures", ".exr", "frame-render", "render,data channels,write"};
inline constexpr StageInfo filtered{"st-filter", "filtered", ".exr", "st-filter", "filter"};
inline constexpr StageInfo walk{"ibr-warp", "walk", ".done", "ibr-warp", "warp"};
inline constexpr StageInfo walked{"frame-render --mask", "walked", ".exr", "frame-render", "render"};
inline constexpr StageInfo smoke{"volume-compose", "smoky", ".exr", "volume-compose", "march"};
inline constexpr StageInfo reference{"frame-render --integrator path", "path", ".exr", "frame-render", "render"};
inline constexpr StageInfo error{"aqm-compare", "error", ".json", "aqm-compare", "compare"};
}  // namespace stage

/// In the order in which they run.
inline constexpr std::array kStages{
    stage::static_photons, stage::photons,        stage::moved_photons, stage::refined,
    stage::static_points,  stage::points,         stage::split,         stage::counts,
    stage::windows,        stage::static_records, stage::records,       stage::kept,
    stage::keys,           stage::walk,           stage::walked,        stage::raw,
    stage::filtered,       stage::pictures,       stage::smoke,         stage::reference,
    stage::error};

/// The wish with all values that it leaves open set by the preset of its quality. draft takes less than half of the
/// time of final.
Wish with_preset(Wish wish);

}  // namespace tempolux
