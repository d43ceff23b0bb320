// lib/plan/decisions.h -- a user's wish and the decisions for a segment.
#pragma once

#include <array>
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lib/pilot/choose_light.h"
#include "lib/pilot/choose_moving.h"

namespace tempolux {

/// The presets: draft has more noise and takes less time (with_preset).
enum class Quality : std::uint8_t { draft, final };
inline constexpr const char* kQualities[] = {"draft", "final"};

/// How the frames of a range are made. frames: each frame is rendered. walkthrough: key frames are rendered, and frames
/// between them are warped. automatic: still in segments where it pays, else frames. preview: indirect light from the
/// photons of many frames. still: while the camera stands, only pixels that change are sampled.
enum class FrameMethod : std::uint8_t { frames, walkthrough, automatic, preview, still };
inline constexpr const char* kFrameMethods[] = {"frames", "walkthrough", "auto", "preview", "still"};

/// METHOD=still: the frame that gives the kept pixels, compared with other frames. kFinerStill: its pixel error over
/// theirs. All frames show its noise, so its noise must not be seen. kFinerStillSamples: the number of its samples over
/// theirs, kFinerStill^(-7/8) (docs/methods/still.md).
inline constexpr double kFinerStill = 0.25, kFinerStillSamples = 3.4;

/// The enumerator with this name, in a list of names by value; empty if no enumerator has it.
template <class Enum, std::size_t n>
std::optional<Enum> named(const char* const (&names)[n], const std::string& name) {
  const auto found = std::ranges::find(names, name);
  return found == std::end(names) ? std::nullopt : std::optional(Enum(found - std::begin(names)));
}

/// Largest number of frames from which an element of a preview collects photons: the frame, 16 before and 16 after it.
inline constexpr int kPreviewWindow = 33;

/// The number of photons of a preview that `make measure` found: with it a viewer sees noise in few enough pixels.
struct Measured {
  std::uint64_t photons = 0;  ///< light paths of a frame
  std::string because;        ///< what was measured, in words
};

/// The user's wish. Options are given as on a command line, separated by blanks.
struct Wish {
  static constexpr int kAutoFilter = -1;  ///< value of `filter`: from the preset
  Quality quality = Quality::final;
  FrameMethod method = FrameMethod::automatic;
  int filter = kAutoFilter;       ///< number of frames in the filter's window, odd; 0: no filter
  std::string indirect = "auto";  ///< "auto", or one of kIndirectMethods
  std::string moving = "auto";    ///< "auto", or one of kMovingMethods
  std::string split = "auto";     ///< or on, off
  int width = 640, height = 360;  ///< of the frames, pixels
  std::uint64_t photons = 0;      ///< light paths per photon map; 0: from the preset
  double pixel_error = 0;         ///< 0: from the preset
  /// Options of irradcache-build points, of irradcache-build records, and of frame-render; "": from the preset.
  std::string points, records, pixels;
  int first_samples = 4;       ///< of a pixel, by the preset
  bool preset_pixels = false;  ///< `pixels` holds the preset's options without --pixel-error, which is in Decisions
  std::string channels = "RGBA,Z,N,id";
  std::optional<double> exposure;    ///< of the previews, stops; empty: what suits the first frame
  std::string smoke_words;           ///< options of volume-compose
  std::string update;                ///< share of the photon groups that is traced again in smoke, "10%"; "": all
  std::string refine;                ///< further light paths for smoke, as a share of a map's paths, "5%"; "": none
  std::string strategy = "census";   ///< which groups: photon-trace --strategy
  int key_distance = 16;             ///< frames between the first keys of a walkthrough
  std::map<int, Measured> measured;  ///< photons of segments, by their first frame
  /// An interval between two keys is halved if a viewer sees errors (AQM) in more than this share of its pixels. Below
  /// 0: from the preset.
  double threshold = -1;
  int reference_samples = 64;  ///< samples per pixel of a report's reference
  std::vector<int> report;     ///< frames that are compared with path tracing
  std::string common;          ///< options of all stages that change content: --fps, --volume ... (only hashed)
  std::string camera;          ///< name of the camera, or auto (only hashed)
  std::optional<std::array<int, 2>> shot;  ///< first and last frame of the shot; empty: those of the animation

  /// Largest share of pixels in which a viewer may see errors (AQM) in pictures of this quality.
  double seen() const { return quality == Quality::draft ? 0.2 : 0.05; }
};

/// The lobes of a segment's materials.
struct MaterialFacts {
  bool lambert = false, other = false;  ///< true if some material has a Lambert lobe; a specular or glossy lobe
};

/// The reason of a decision about a stage, in words.
struct Reason {
  std::string stage;
  std::string because;
};

/// The decisions for a segment. They depend only on the scene, the wish and the segment.
struct Decisions {
  std::string kinds;  ///< kinds of photons that later stages read: "caustic,indirect"; "": no photons
  IndirectMethod indirect = IndirectMethod::records;
  bool caustic_map = false;  ///< true: visible caustic light is read from photons; false: camera paths find it
  std::uint64_t photon_paths = 700'000;  ///< light paths of a photon map
  int record_rays = 500;
  int static_ray_factor = 1;  ///< gather rays of a static record over those of a record of one state of light
  double pixel_error = 0;     ///< --pixel-error of frames, if the wish leaves their pixels to the preset
  double texture_width = 0;   ///< m, standard deviation of the filter of a preview's light textures; 0: no preview
  bool split = false;         ///< true: bright points are divided from the other points and sampled explicitly
  MovingMethod moving = MovingMethod::anew;
  double new_share = 0;  ///< mean share of a picture that the picture before does not show
  int together = 1;      ///< number of consecutive pictures whose cameras share records

  /// Records for the cameras of this many consecutive pictures, as a multiple of one picture's records.
  static double records_of(double pictures, double new_share) { return 1 + new_share * (pictures - 1); }
  double records_of(double pictures) const { return records_of(pictures, new_share); }
  bool walk = false;  ///< true: warping can make pictures between key frames
  /// True if frames cost less that keep pixels of the shot's middle frame (METHOD=still). METHOD=auto then keeps them.
  bool still = false;
  std::string view;         ///< content of the view file by which photons are aimed and points spread; "": none
  std::vector<int> looked;  ///< frames for which pilots ran
  std::vector<Reason> reasons;

  bool photons() const { return !kinds.empty(); }
  bool points() const { return photons() && indirect != IndirectMethod::paths; }
  bool records() const { return photons() && indirect == IndirectMethod::records; }
  int static_rays() const { return static_ray_factor * record_rays; }
};

}  // namespace tempolux
