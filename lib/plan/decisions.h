// lib/plan/decisions.h -- what is decided for a segment, and what the user has wished.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/render/choose_light.h"
#include "lib/render/choose_moving.h"

namespace tempolux {

enum class Quality : std::uint8_t { draft, final };
inline constexpr const char* kQualities[] = {"draft", "final"};

enum class FrameMethod : std::uint8_t { frames, walkthrough, automatic, preview };
inline constexpr const char* kFrameMethods[] = {"frames", "walkthrough", "auto", "preview"};

/// A preview's elements collect photons over this many frames at most, those before, at and after a frame.
inline constexpr int kPreviewWindow = 33;

/// What the user asks for. Words are options as on a command line, separated by blanks.
struct Wish {
  static constexpr int kAutoFilter = -1;  ///< as the preset has it
  Quality quality = Quality::final;
  FrameMethod method = FrameMethod::frames;
  int filter = kAutoFilter;       ///< frames of the filter's window, odd; 0: no filter
  std::string indirect = "auto";  ///< or one of kIndirectMethods
  std::string moving = "auto";    ///< or one of kMovingMethods
  std::string split = "auto";     ///< or on, off
  int width = 640, height = 360;  ///< of the frames, pixels
  std::uint64_t photons = 0;      ///< paths of light of a map; 0: the preset's
  int rays = 0;                   ///< of a record at most; 0: the preset's
  double pixel_error = 0;         ///< 0: the preset's
  std::string points, records,
      pixels;                  ///< words for irradcache-build points, records and frame-render; "": the preset's
  bool preset_pixels = false;  ///< `pixels` are the preset's, without --pixel-error: Decisions has it
  std::string channels = "RGBA,Z,N,id";
  bool textures = false;  ///< SURFACES=textures: indirect light in smoke by light textures
  std::string texture_words, smoke_words;
  std::string update;  ///< share of the photon groups that is traced anew in smoke, "10%"; "": all
  std::string refine;  ///< further paths for what smoke shows of a map, as a share of its paths, "5%"; "": none
  std::string strategy = "census";  ///< which groups, as photon-trace --strategy
  int key_distance = 16;            ///< frames between the first keys of a walkthrough
  double threshold = 0.05;  ///< an interval of a walkthrough is halved if a viewer sees in a larger share of its pixels
                            ///< that they are wrong (AQM)
  int reference_samples = 64;  ///< of a pixel of the reference that a report compares with
  std::vector<int> report;     ///< frames to compare with path tracing
  std::string common;  ///< words of all stages that shape content: --fps, --volume ... (they are hashed, not used)
  std::string camera;  ///< name of the camera, or auto (hashed, not used)
};

/// How the materials of a segment reflect.
struct MaterialFacts {
  bool lambert = false, other = false;  ///< some reflect by a Lambert lobe; some by a mirror or glossy lobe
};

/// A fact that decides whether a stage has work.
struct Reason {
  std::string stage;
  std::string because;
};

/// What a segment needs. A function of the scene, the wish and the segment.
struct Decisions {
  std::string kinds;  ///< of photons that later stages read: "caustic,indirect"; "": no photons
  IndirectMethod indirect = IndirectMethod::records;
  bool caustic_map = false;              ///< caustic light where the eye looks is read from photons; else paths find it
  std::uint64_t photon_paths = 700'000;  ///< of a photon map
  int record_rays = 500;
  double pixel_error = 0;     ///< of frames, where the wish leaves their pixels to the preset
  double texture_width = 0;   ///< of a preview's light textures, m: deviation of their filter; 0: no preview
  bool learn_lights = false;  ///< light from far away comes through openings: it is learned which way
  bool split = false;         ///< bright points are divided from the others and sampled explicitly
  MovingMethod moving = MovingMethod::anew;
  double new_share = 0;  ///< of what a picture shows, that the pictures of the segment before it do not
  int together = 1;      ///< pictures, one after the other, whose cameras share records

  /// Records for the cameras of so many pictures, one after the other; in records of one.
  double records_of(double pictures) const { return 1 + new_share * (pictures - 1); }
  bool walk = false;        ///< key frames and warping pay: METHOD=auto follows it
  std::string view;         ///< content of the view file by which photons are aimed and points spread; "": none
  std::vector<int> looked;  ///< frames of the pilots
  std::vector<Reason> reasons;

  bool photons() const { return !kinds.empty(); }
  bool points() const { return photons() && indirect != IndirectMethod::paths; }
  bool records() const { return photons() && indirect == IndirectMethod::records; }
};

}  // namespace tempolux
