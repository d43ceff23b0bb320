// lib/warp/warp.h -- a frame between key frames, from their pixels; and which of its pixels must be traced.
//
// The target's own depth is known (its rays are traced, or it is read), so pixels are fetched, not thrown: each target
// pixel looks up the point it shows in every key. There are no cracks where a key is magnified, and no ghosts: what a
// key shows instead of the point is not taken. docs/methods/warping.md.
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

/// Where do keys give light by mirrors, glass and gloss wrongly? Planes are R, G, B.
struct GlossInDoubt {
  std::array<std::vector<float>, 3> picture;  ///< composed of both keys
  std::array<std::vector<float>, 3>
      error;                          ///< what the keys' specular light differs by, 0 where one key alone gives it
  std::vector<std::uint8_t> counted;  ///< 0: the pixel is masked already
};

/// The picture to make.
struct WarpTarget {
  const FrameCamera* camera = nullptr;
  const SeenSurfaces* seen = nullptr;
  /// What is seen between pixel centres; empty: not known, then pixels with an edge are masked.
  std::function<void(std::span<const RasterPoint>, FacePoint*)> look;
  const std::vector<float>* speed = nullptr;  ///< deg/s by pixel; nullptr: not known, none is slow
  /// The probability by pixel that a viewer sees the error; empty: everything that shines and was moved is masked.
  std::function<std::vector<float>(const GlossInDoubt&)> see_gloss;
  std::vector<std::uint8_t> gloss;  ///< by pixel, 1: a surface that mirrors or lets light through; empty: not known
};

/// A key of the frame, and how far away in time it is.
struct WarpKey {
  const KeyView* view = nullptr;
  double frames_away = 0;         ///< >= 0
  bool cut_off = false;           ///< a cut lies between: nothing of it is taken
  bool light_may_differ = false;  ///< what lights or shades the scene is not the same as in the target's frame
};

struct WarpOptions {
  /// Light by mirror, glass and gloss that one key alone gives is believed up to this share of a pixel's light. A pixel
  /// counts as no darker than a tenth of the picture's mean, as in relMSE. Of what two keys give WarpTarget::see_gloss
  /// decides.
  double specular_share = 0.02;
  double seen_probability = 0.75;  ///< above which an error is seen (docs/methods/vision.md)
  /// A pixel composed of several surfaces is believed if both keys give it alike, to this share of its light; a key
  /// shows what lies at an edge, a contact's shadow above all, only from a pixel's distance.
  double edge_share = 0.05;
  double slow_deg_per_s = 1.41;  ///< pixels that move, but less, are masked; see slow_speed.h
  double most_magnified = 4;     ///< target pixels per pixel of the key
  /// The keys' light differs if its mean over 5x5 pixels does by more than 3 of its standard errors and this share.
  double light_share = 0.02;
  bool separate = false;  ///< keep what each key alone gives
};

struct WarpedFrame {
  std::vector<std::string> names;          ///< of the colour channels, ascending
  std::vector<std::vector<float>> colour;  ///< by name, then by pixel; 0 where nothing was found
  std::vector<std::uint32_t> why;          ///< sums of formats::Why
  /// With WarpOptions::separate: what each key alone gives, laid out as `colour`. Where it does not give the whole
  /// pixel, or the pixel stands still, it is what was composed: comparing two candidates finds no difference there.
  /// What stands is exact, and the keys' noise is no error of warping.
  std::vector<std::vector<std::vector<float>>> candidates;
};

/// Composites one or two keys; both need the same colour channels (std::invalid_argument). Weights of keys that show a
/// point: nearness in time over magnification, where that is above 1. All layers are weighted alike; where all parts of
/// RGB are there their sum is RGB to the bit, as in rendered frames. Pixels that no key has are 0 and masked.
WarpedFrame warp(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options);

}  // namespace tempolux
