// lib/warp/warp.h -- warps a frame from key frames, and decides which of its pixels must be traced.
//
// The target's depth is given (traced, or read from a file), so warping is backward: each target pixel looks up its own
// surface point in every key. A magnified key leaves no cracks, and a pixel in which the key shows another surface is
// not used, which avoids ghosts. docs/methods/warping.md.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/mask/why.h"
#include "lib/warp/look_up.h"

namespace tempolux {

/// Where light by mirrors, glass and gloss may be wrong in the keys. Planes are R, G, B.
struct GlossInDoubt {
  std::array<std::vector<float>, 3> picture;  ///< composed from both keys
  std::array<std::vector<float>, 3> error;    ///< difference of the keys' specular light; 0 where only one key gives it
  std::vector<std::uint8_t> counted;          ///< 0: the pixel is masked already
};

/// The picture to warp to.
struct WarpTarget {
  const FrameCamera* camera = nullptr;
  const SeenSurfaces* seen = nullptr;
  /// Finds the surfaces between pixel centres. Empty: unknown, and pixels with an edge are masked.
  std::function<void(std::span<const RasterPoint>, FacePoint*)> look;
  const std::vector<float>* speed = nullptr;  ///< deg/s by pixel; nullptr: unknown, no pixel is slow
  /// The probability by pixel that a viewer sees the error. Empty: every moved pixel with specular light is masked.
  std::function<std::vector<float>(const GlossInDoubt&)> see_gloss;
  std::vector<std::uint8_t> gloss;  ///< by pixel, 1: the surface mirrors or transmits light; empty: unknown
};

/// A key frame and its distance in time.
struct WarpKey {
  const KeyView* view = nullptr;
  double frames_away = 0;         ///< >= 0
  bool cut_off = false;           ///< a cut lies between key and target: the key is not used
  bool light_may_differ = false;  ///< the lights, or objects that cast shadows, differ from the target's frame
};

struct WarpOptions {
  /// Specular light that only one key gives is accepted up to this share of a pixel's light. A pixel counts as no
  /// darker than a tenth of the picture's mean, as in relMSE. If two keys give the light, WarpTarget::see_gloss
  /// decides.
  double specular_share = 0.02;
  double seen_probability = 0.75;  ///< probability above which an error counts as seen (docs/methods/vision.md)
  /// A pixel composed of several surfaces is accepted if the keys' colours agree to this share of the pixel's light.
  /// The colours come from pixels of keys that show one surface alone. Such pixels are at least a pixel away from the
  /// edge, so they may miss what lies at the edge itself, such as a contact shadow.
  double edge_share = 0.05;
  double slow_deg_per_s = 1.41;  ///< moving pixels slower than this are masked; see slow_speed.h
  double most_magnified = 4;     ///< largest area in target pixels of a key's pixel
  /// The keys' light differs if its mean over 5x5 pixels does, by more than 3 standard errors and this share.
  double light_share = 0.02;
  bool separate = false;  ///< also return the colours of each key alone
};

struct WarpedFrame {
  std::vector<std::string> names;          ///< names of the colour channels, ascending
  std::vector<std::vector<float>> colour;  ///< by name, then by pixel; 0 where no key shows the point
  std::vector<std::uint32_t> why;          ///< by pixel, sums of formats::Why
  /// With WarpOptions::separate: the colours from each key alone, laid out as `colour`. Where a key does not give the
  /// whole pixel, or the pixel has not moved, the composed colour is taken, so that a comparison of two candidates
  /// finds no difference there: unmoved pixels are exact, and the keys' noise is no error of warping.
  std::vector<std::vector<std::vector<float>>> candidates;
};

/// Composes one or two keys, which must have the same colour channels (else std::invalid_argument). The weight of a key
/// that shows a point is linear in time, divided by its magnification if that is above 1. All layers have the same
/// weights. If all layers are there, RGB is their sum to the bit, as in rendered frames. Pixels that no key shows are 0
/// and masked.
WarpedFrame warp(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options);

}  // namespace tempolux
