// lib/plan/stages.h -- the table of the pipeline's stages, the only list of them: the plan, its rules for make,
// its costs, progress, clean, the pages and the benches read it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "lib/plan/decisions.h"

namespace tempolux {

/// Which of the user's options the command of a stage gets besides its own options. Each value includes the options of
/// the values before it.
enum class Sees : std::uint8_t {
  files,   ///< no option: the command reads files of earlier stages only
  scene,   ///< the scene, and the options of all tools that read a scene, with the camera and its shutter
  drawn,   ///< the seed: the command draws random numbers
  camera,  ///< the camera's lens
};

/// The part of the work that a stage belongs to.
enum class Part : std::uint8_t { photons, points, cache, frames, report };
inline constexpr const char* kParts[] = {"photons", "points", "cache", "frames", "report"};

/// A stage makes one kind of file.
struct StageInfo {
  std::string_view folder;   ///< in OUT, holds its files
  std::string_view name;     ///< name of the stage in plan.json
  std::string_view command;  ///< the program, and the subcommand where it has one
  Sees sees;
  /// Options that name what the command writes. @ stands for FOLDER/FRAMES-KEY, % for the first file. "":
  /// pipelines/stages.mk has the rule.
  std::string_view outputs = "-o % --stats @.json";
  std::string_view extensions;  ///< of its files, separated by blanks; later stages read the first
  Part part;
  std::string_view words;  ///< what the stage makes, for people
  /// Cost of one command: CPU seconds, and the largest resident memory in MB. Measured with the demo at 640x360; the
  /// cost of smoke with a room of 1 m. A plan shows these figures until `make estimate` has measured its own.
  double cpu_s, memory_mb;
  /// Phases of its statistics whose time grows with the work, separated by commas.
  std::string_view work;

  std::string_view tool() const { return command.substr(0, command.find(' ')); }
  /// True if the stage makes pictures that a user may ask for. A picture of stage `still` only serves other pictures.
  bool makes_pictures() const { return part == Part::frames && extensions == ".exr" && folder != "still"; }
};

inline constexpr std::string_view kTracing = "trace,commit", kPlacing = "read photons,points,write",
                                  kRendering = "render,data channels,write";

/// All stages, in the order in which they run.
inline constexpr auto kStages = std::to_array<StageInfo>({
    {.folder = "stands",
     .name = "photon-trace --map static",
     .command = "photon-trace",
     .sees = Sees::drawn,
     .extensions = ".photons",
     .part = Part::photons,
     .words = "photons of the static scene",
     .cpu_s = 1,
     .memory_mb = 23,
     .work = kTracing},
    {.folder = "touched",
     .name = "photon-trace --map static --paths",
     .command = "photon-trace",
     .sees = Sees::drawn,
     .outputs = "--paths % --stats @.json",
     .extensions = ".paths",
     .part = Part::photons,
     .words = "light paths that movers touch",
     .cpu_s = 1,
     .memory_mb = 23,
     .work = kTracing},
    {.folder = "photons",
     .name = "photon-trace",
     .command = "photon-trace",
     .sees = Sees::drawn,
     .extensions = ".photons",
     .part = Part::photons,
     .words = "photons",
     .cpu_s = 1,
     .memory_mb = 23,
     .work = kTracing},
    {.folder = "moved",
     .name = "photon-trace --map dynamic",
     .command = "photon-trace",
     .sees = Sees::drawn,
     .extensions = ".photons",
     .part = Part::photons,
     .words = "photons that movers change",
     .cpu_s = 0.1,
     .memory_mb = 22,
     .work = kTracing},
    {.folder = "refined",
     .name = "photon-trace --refine",
     .command = "photon-trace",
     .sees = Sees::drawn,
     .extensions = ".photons",
     .part = Part::photons,
     .words = "more photons where smoke is noisy",
     .cpu_s = 0.4,
     .memory_mb = 17,
     .work = kTracing},
    {.folder = "stands_points",
     .name = "irradcache-build points --map static",
     .command = "irradcache-build points",
     .sees = Sees::drawn,
     .extensions = ".irradpoints",
     .part = Part::points,
     .words = "light on static surfaces",
     .cpu_s = 1.1,
     .memory_mb = 84,
     .work = kPlacing},
    {.folder = "points",
     .name = "irradcache-build points",
     .command = "irradcache-build points",
     .sees = Sees::drawn,
     .extensions = ".irradpoints",
     .part = Part::points,
     .words = "light on surfaces",
     .cpu_s = 0.7,
     .memory_mb = 87,
     .work = kPlacing},
    {.folder = "split",
     .name = "photonmap-split",
     .command = "photonmap-split",
     .sees = Sees::files,
     .outputs = "--low @.low.irradpoints --high @.high.irradpoints --stats @.json",
     .extensions = ".low.irradpoints .high.irradpoints",
     .part = Part::points,
     .words = "bright points apart",
     .cpu_s = 0.1,
     .memory_mb = 23,
     .work = "split"},
    {.folder = "counts",
     .name = "st-filter mesh --counts",
     .command = "st-filter mesh",
     .sees = Sees::scene,
     .extensions = ".meshirrad",
     .part = Part::cache,
     .words = "photons counted",
     .cpu_s = 0.1,
     .memory_mb = 72,
     .work = "count,write"},
    {.folder = "windows",
     .name = "gather-temporal density",
     .command = "gather-temporal density",
     .sees = Sees::scene,
     .extensions = ".meshirrad",
     .part = Part::cache,
     .words = "light from photons of many frames",
     .cpu_s = 2.2,
     .memory_mb = 221,
     .work = "read counts,windows,filter,write"},
    {.folder = "stands_cache",
     .name = "irradcache-build records --map static",
     .command = "irradcache-build records",
     .sees = Sees::camera,
     .extensions = ".irradcache",
     .part = Part::cache,
     .words = "indirect light on static surfaces",
     .cpu_s = 13,
     .memory_mb = 66,
     .work = "records"},
    {.folder = "cache",
     .name = "irradcache-build records",
     .command = "irradcache-build records",
     .sees = Sees::camera,
     .extensions = ".irradcache",
     .part = Part::cache,
     .words = "indirect light",
     .cpu_s = 3.4,
     .memory_mb = 92,
     .work = "records"},
    {.folder = "kept",
     .name = "gather-temporal final",
     .command = "gather-temporal final",
     .sees = Sees::camera,
     .outputs = "-o @.radsamples --cache @.irradcache --stats @.json",
     .extensions = ".irradcache .radsamples",
     .part = Part::cache,
     .words = "indirect light, kept over time",
     .cpu_s = 6.4,
     .memory_mb = 100,
     .work = "records"},
    {.folder = "keys",
     .name = "frame-render (keys)",
     .command = "frame-render",
     .sees = Sees::camera,
     .extensions = ".exr",
     .part = Part::frames,
     .words = "pixels of a key frame",
     .cpu_s = 7.2,
     .memory_mb = 210,
     .work = kRendering},
    {.folder = "walk",
     .name = "ibr-warp",
     .command = "ibr-warp",
     .sees = Sees::camera,
     .outputs = "",
     .extensions = ".done",
     .part = Part::frames,
     .words = "distance of keys",
     .cpu_s = 0.2,
     .memory_mb = 210,
     .work = "warp"},
    {.folder = "walked",
     .name = "frame-render --mask",
     .command = "frame-render",
     .sees = Sees::camera,
     .outputs = "",
     .extensions = ".exr",
     .part = Part::frames,
     .words = "warped from keys",
     .cpu_s = 7.2,
     .memory_mb = 210,
     .work = "warp,render"},
    {.folder = "still",
     .name = "frame-render (still)",
     .command = "frame-render",
     .sees = Sees::camera,
     .extensions = ".exr",
     .part = Part::frames,
     .words = "pixels that stay",
     .cpu_s = 28,
     .memory_mb = 329,
     .work = kRendering},
    {.folder = "raw",
     .name = "frame-render (raw)",
     .command = "frame-render",
     .sees = Sees::camera,
     .extensions = ".exr",
     .part = Part::frames,
     .words = "pixels",
     .cpu_s = 8.3,
     .memory_mb = 329,
     .work = kRendering},
    {.folder = "filtered",
     .name = "st-filter",
     .command = "st-filter",
     .sees = Sees::files,
     .extensions = ".exr",
     .part = Part::frames,
     .words = "noise filter",
     .cpu_s = 0.8,
     .memory_mb = 248,
     .work = "filter"},
    {.folder = "pictures",
     .name = "frame-render",
     .command = "frame-render",
     .sees = Sees::camera,
     .extensions = ".exr",
     .part = Part::frames,
     .words = "pixels",
     .cpu_s = 8.9,
     .memory_mb = 183,
     .work = kRendering},
    {.folder = "smoky",
     .name = "volume-compose",
     .command = "volume-compose",
     .sees = Sees::camera,
     .extensions = ".exr",
     .part = Part::frames,
     .words = "smoke",
     .cpu_s = 2.8,
     .memory_mb = 44,
     .work = "march"},
    {.folder = "path",
     .name = "frame-render --integrator path",
     .command = "frame-render",
     .sees = Sees::camera,
     .extensions = ".exr _a.exr _b.exr",
     .part = Part::report,
     .words = "path-traced reference",
     .cpu_s = 60,
     .memory_mb = 210,
     .work = "render"},
    {.folder = "error",
     .name = "aqm-compare",
     .command = "aqm-compare",
     .sees = Sees::files,
     .outputs = "--json @.json --quiet",
     .extensions = ".json",
     .part = Part::report,
     .words = "comparison",
     .cpu_s = 0.2,
     .memory_mb = 100,
     .work = "compare"},
});

/// Returns the stage that writes its files into this folder of OUT. An unknown folder does not compile.
consteval const StageInfo& stage_in(std::string_view folder) {
  for (const StageInfo& stage : kStages)
    if (stage.folder == folder) return stage;
  throw "no stage has this folder";
}

/// The wish with all values that it leaves open set by the preset of its quality. draft takes less than half of the
/// time of final.
Wish with_preset(Wish wish);

}  // namespace tempolux
