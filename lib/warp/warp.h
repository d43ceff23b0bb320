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

/// Light of mirrors, glass and gloss, about which the keys differ. Planes are R, G, B.
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
  std::function<void(std::span<const RasterPoint>, FacePoint*)> look;  ///< SceneView::look
  const std::vector<float>* speed = nullptr;  ///< deg/s by pixel; nullptr: unknown, no pixel is slow
  /// The probability by pixel that a viewer sees the error (error_probability() in lib/aqm). Empty: every moved pixel
  /// with specular light is masked.
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

/// Limits of the errors that warping may cause.
struct WarpOptions {
  /// Specular light that only one key shows is accepted up to this share of a pixel's light. A pixel counts as at least
  /// a tenth as bright as the picture's mean, as in relMSE. If both keys show the light, WarpTarget::see_gloss decides.
  double specular_share = 0.02;
  double seen_probability = 0.75;  ///< probability above which an error counts as seen (docs/methods/vision.md)
  /// A pixel that shows several surfaces is accepted if the keys' colours differ by at most this share of the pixel's
  /// light. These colours come from pixels of the keys that show a single surface, at least a pixel away from the edge.
  /// They may miss light at the edge itself, such as a contact shadow.
  double edge_share = 0.05;
  double slow_deg_per_s = 1.41;  ///< moving pixels slower than this are masked; see vision::slow_speed()
  double most_magnified = 4;     ///< largest number of target pixels that a pixel of a key may cover
  /// The light of two keys differs if its mean over 5 x 5 pixels differs by more than this share, and by more than can
  /// be noise (Masking::mark_changed_light).
  double light_share = 0.02;
  bool separate = false;  ///< also return the colours of each key alone
};

/// The result of warp().
struct WarpedFrame {
  std::vector<std::string> names;          ///< names of the colour channels, ascending
  std::vector<std::vector<float>> colour;  ///< by name, then by pixel; 0 where no key shows the point
  std::vector<std::uint32_t> why;          ///< by pixel, sums of formats::Why
  /// With WarpOptions::separate: the colours from each key alone, laid out as `colour`. In a pixel that a key does not
  /// show whole, or that has not moved, the candidate is the composed colour. A comparison of the two candidates then
  /// finds no difference there: unmoved pixels are exact, and the keys' noise is no error of warping.
  std::vector<std::vector<std::vector<float>>> candidates;
};

/// Composes one or two keys. Both must have the same colour channels (else std::invalid_argument). If a key shows a
/// point, the key's weight falls linearly with its distance in time. A key that shows the point magnified has a weight
/// that is divided by the magnification. All layers have the same weights. If the keys have all layers, R, G and B are
/// the exact sum of the composed layers, as in rendered frames. A pixel that no key shows is 0 and masked.
WarpedFrame warp(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options);

}  // namespace tempolux
