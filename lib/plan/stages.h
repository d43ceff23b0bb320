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
  scene,   ///< the scene, and the options of all tools that read a scene
  drawn,   ///< the seed: the command draws random numbers
  camera,  ///< the camera and its lens
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
  std::string_view outputs;
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

inline constexpr std::string_view kUsual = "-o % --stats @.json";
inline constexpr std::string_view kTracing = "trace,commit", kPlacing = "read photons,points,write",
                                  kRendering = "render,data channels,write";

/// All stages, in the order in which they run.
inline constexpr auto kStages = std::to_array<StageInfo>({
    {"stands", "photon-trace --map static", "photon-trace", Sees::drawn, kUsual, ".photons", Part::photons,
     "photons of the static scene", 1, 23, kTracing},
    {"touched", "photon-trace --map static --paths", "photon-trace", Sees::drawn, "--paths % --stats @.json", ".paths",
     Part::photons, "light paths that movers touch", 1, 23, kTracing},
    {"photons", "photon-trace", "photon-trace", Sees::drawn, kUsual, ".photons", Part::photons, "photons", 1, 23,
     kTracing},
    {"moved", "photon-trace --map dynamic", "photon-trace", Sees::drawn, kUsual, ".photons", Part::photons,
     "photons that movers change", 0.1, 22, kTracing},
    {"refined", "photon-trace --refine", "photon-trace", Sees::drawn, kUsual, ".photons", Part::photons,
     "more photons where smoke is noisy", 0.4, 17, kTracing},
    {"stands_points", "irradcache-build points --map static", "irradcache-build points", Sees::drawn, kUsual,
     ".irradpoints", Part::points, "light on static surfaces", 1.1, 84, kPlacing},
    {"points", "irradcache-build points", "irradcache-build points", Sees::drawn, kUsual, ".irradpoints", Part::points,
     "light on surfaces", 0.7, 87, kPlacing},
    {"split", "photonmap-split", "photonmap-split", Sees::files,
     "--low @.low.irradpoints --high @.high.irradpoints --stats @.json", ".low.irradpoints .high.irradpoints",
     Part::points, "bright points apart", 0.1, 23, "split"},
    {"counts", "st-filter mesh --counts", "st-filter mesh", Sees::scene, kUsual, ".meshirrad", Part::cache,
     "photons counted", 0.1, 72, "count,write"},
    {"windows", "gather-temporal density", "gather-temporal density", Sees::scene, kUsual, ".meshirrad", Part::cache,
     "light from photons of many frames", 2.2, 221, "read counts,windows,filter,write"},
    {"stands_cache", "irradcache-build records --map static", "irradcache-build records", Sees::camera, kUsual,
     ".irradcache", Part::cache, "indirect light on static surfaces", 13, 66, "records"},
    {"cache", "irradcache-build records", "irradcache-build records", Sees::camera, kUsual, ".irradcache", Part::cache,
     "indirect light", 3.4, 92, "records"},
    {"kept", "gather-temporal final", "gather-temporal final", Sees::camera,
     "-o @.radsamples --cache @.irradcache --stats @.json", ".irradcache .radsamples", Part::cache,
     "indirect light, kept over time", 6.4, 100, "records"},
    {"keys", "frame-render (keys)", "frame-render", Sees::camera, kUsual, ".exr", Part::frames, "pixels of a key frame",
     7.2, 210, kRendering},
    {"walk", "ibr-warp", "ibr-warp", Sees::camera, "", ".done", Part::frames, "distance of keys", 0.2, 210, "warp"},
    {"walked", "frame-render --mask", "frame-render", Sees::camera, "", ".exr", Part::frames, "warped from keys", 7.2,
     210, "render"},
    {"still", "frame-render (still)", "frame-render", Sees::camera, kUsual, ".exr", Part::frames, "pixels that stay",
     28, 329, kRendering},
    {"raw", "frame-render (raw)", "frame-render", Sees::camera, kUsual, ".exr", Part::frames, "pixels", 8.3, 329,
     kRendering},
    {"filtered", "st-filter", "st-filter", Sees::files, kUsual, ".exr", Part::frames, "noise filter", 0.8, 248,
     "filter"},
    {"pictures", "frame-render", "frame-render", Sees::camera, kUsual, ".exr", Part::frames, "pixels", 8.9, 183,
     kRendering},
    {"smoky", "volume-compose", "volume-compose", Sees::camera, kUsual, ".exr", Part::frames, "smoke", 2.8, 44,
     "march"},
    {"path", "frame-render --integrator path", "frame-render", Sees::camera, kUsual, ".exr _a.exr _b.exr", Part::report,
     "path-traced reference", 60, 210, "render"},
    {"error", "aqm-compare", "aqm-compare", Sees::files, "--json @.json --quiet", ".json", Part::report, "comparison",
     0.2, 100, "compare"},
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
