// lib/aqm/animation_quality.h -- AQM: which share of the pixels of a frame, or of a sequence, a viewer would
// see to differ.
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

/// Who looks, at which display. One of these holds for both frames and the whole sequence.
struct VisionOptions {
  vision::Display display;
  vision::Gaze gaze = vision::Gaze::track;
  double frames_per_second = 24;
  double exposure_stops = 0;  ///< linear values times 2^stops are what the display gets
  /// Frame and reference are estimates of one picture that err alike and independently. Then either errs by their
  /// difference over sqrt(2) (root mean square): that is what is judged, around their mean.
  bool of_either = false;
};

/// Of `pixels` that count, `seen` have a probability above kSeenProbability.
struct SeenShare {
  std::uint64_t pixels = 0, seen = 0;
  double share() const { return pixels ? double(seen) / double(pixels) : 0; }
  void add(const SeenShare& other) { pixels += other.pixels, seen += other.seen; }
};

/// AQM of a frame, or of a sequence taken together.
struct AnimationQuality {
  SeenShare all;
  std::map<std::uint32_t, SeenShare> objects;  ///< by id.object; empty without it
  double adaptation_luminance = 0;             ///< cd/m2, of a frame; 0 for a sequence
  void add(const AnimationQuality& frame);
};

/// AQM of a frame and its map.
struct JudgedFrame {
  AnimationQuality quality;
  std::vector<float> probability;  ///< per pixel; 0 where pixels do not count
};

/// The exposure for a pair that was given none: the mean of what auto_exposure_stops() chooses for the frame
/// and for its reference, so that their order does not matter.
double shared_exposure_stops(const ComparedInputs& inputs);

/// Judges a frame as a viewer would who sees it and its reference one after the other. The reference in
/// halves is their mean. Without flow a still picture is judged, in which eyes look around. `name` begins messages.
/// Throws InputError if the layer is no colour or the flow has another size.
JudgedFrame judge_frame(const Compared& pair, const PixelFlow* flow, const VisionOptions& options,
                        const std::string& name);

/// The probability by pixel that a viewer sees that a picture errs by `error`: judged is picture + error / 2 beside
/// picture - error / 2, at the exposure that suits the picture. Planes are R, G, B; pixels where `counted` is 0 are
/// taken for right.
std::vector<float> error_probability(const std::array<std::vector<float>, 3>& picture,
                                     const std::array<std::vector<float>, 3>& error,
                                     const std::vector<std::uint8_t>& counted, const PixelFlow& flow,
                                     VisionOptions options);

/// The probabilities as an image of one channel, P.
Image probability_image(const JudgedFrame& judged, int width, int height);

/// Probabilities over the frame in grey: yellow where differences may be seen, red where they are.
Picture heat_map(const JudgedFrame& judged, const Image& frame, const PreviewOptions& preview);

}  // namespace tempolux
