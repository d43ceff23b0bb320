// lib/aqm/animation_quality.h -- AQM: the share of the pixels of a frame, or of a sequence, in which a viewer sees a
// difference.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lib/aqm/compared.h"
#include "lib/aqm/display.h"
#include "lib/aqm/vision_model.h"
#include "lib/image/pixel_flow.h"
#include "lib/image/preview.h"

namespace tempolux {

/// The viewer and the display, the same for both frames and the whole sequence.
struct VisionOptions {
  vision::Display display;
  vision::Gaze gaze = vision::Gaze::track;
  double frames_per_second = 24;
  double exposure_stops = 0;  ///< the display gets linear values times 2^stops
  /// True if frame and reference are independent estimates of one picture with equal errors. The error of each is
  /// then their difference divided by sqrt(2) (root mean square). The judged pair has this difference, and the same
  /// mean as frame and reference.
  bool of_either = false;
};

/// `pixels`: pixels that count. `seen`: those with a probability above kSeenProbability.
struct SeenShare {
  std::uint64_t pixels = 0, seen = 0;
  double share() const { return pixels ? double(seen) / double(pixels) : 0; }
  void add(const SeenShare& other) { pixels += other.pixels, seen += other.seen; }
};

/// AQM of a frame, or of a sequence as a whole.
struct AnimationQuality {
  SeenShare all;
  std::map<std::uint32_t, SeenShare> objects;  ///< by id.object; empty without it
  double adaptation_luminance = 0;             ///< cd/m2, for a frame; 0 for a sequence
  void add(const AnimationQuality& frame);
};

/// AQM of a frame, and its map.
struct JudgedFrame {
  AnimationQuality quality;
  std::vector<float> probability;  ///< by pixel; 0 where pixels do not count
};

/// The exposure for a pair without a given one: the mean of auto_exposure_stops() of the frame and of its reference, so
/// that their order does not matter.
double shared_exposure_stops(const ComparedInputs& inputs);

/// Judges a frame as a viewer who sees it and its reference one after the other. If the reference has halves, their
/// mean is used. Without flow the frame is judged as a still picture in which eyes look around. `name` begins messages.
/// Throws InputError if the layer is not a colour or the flow has another size.
JudgedFrame judge_frame(const Compared& pair, const PixelFlow* flow, const VisionOptions& options,
                        const std::string& name);

/// The probability by pixel that a viewer sees the error `error` of a picture. It is the probability to distinguish
///     picture + error / 2  from  picture - error / 2
/// at the picture's automatic exposure. Planes are R, G, B; pixels where `counted` is 0 have no error.
std::vector<float> error_probability(const std::array<std::vector<float>, 3>& picture,
                                     const std::array<std::vector<float>, 3>& error,
                                     const std::vector<std::uint8_t>& counted, const PixelFlow& flow,
                                     VisionOptions options);

/// The probabilities as an image of one channel, P.
Image probability_image(const JudgedFrame& judged, int width, int height);

/// Colours the frame, in grey, by probability: yellow where a viewer may see a difference, red where a difference
/// counts as seen.
Picture heat_map(const JudgedFrame& judged, const Image& frame, const PreviewOptions& preview);

}  // namespace tempolux
