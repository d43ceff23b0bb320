// lib/aqm/animation_quality.cpp -- judges frames and sequences by AQM.
#include "lib/aqm/animation_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/error.h"
#include "lib/aqm/display_speed.h"
#include "lib/aqm/visible_difference.h"
#include "lib/core/parallel.h"

namespace tempolux {
namespace {

void check_colour(const Compared& pair, const std::string& name) {
  const bool colour = pair.channels == std::vector<std::string>{"R", "G", "B"};
  if (colour || pair.channels == std::vector<std::string>{"Y"}) return;
  throw InputError(name +
                   ": the layer is no colour, so no eye sees it; choose another --layer, or leave out "
                   "--metric aqm and --flow");
}

/// Luminance of the mixture share x frame + (1 - share) x reference (or the mean of its halves).
std::vector<float> shown_luminance(const Compared& pair, double share, const vision::Display& display,
                                   double exposure) {
  if (share == 1) return displayed_luminance(display, pair.test, exposure);
  if (share == 0 && !pair.halves()) return displayed_luminance(display, pair.reference, exposure);
  std::vector<std::vector<float>> mixtures(pair.test.size());
  std::vector<const std::vector<float>*> planes;
  for (std::size_t c = 0; c < mixtures.size(); ++c) {
    mixtures[c].resize(pair.test[c]->size());
    for (std::size_t i = 0; i < mixtures[c].size(); ++i) {
      const double reference = pair.reference_at(c, i);
      mixtures[c][i] = float(reference + share * (double((*pair.test[c])[i]) - reference));
    }
    planes.push_back(&mixtures[c]);
  }
  return displayed_luminance(display, planes, exposure);
}

AnimationQuality count_seen(const Compared& pair, const std::vector<float>& probability) {
  AnimationQuality quality;
  for (std::size_t i = 0; i < probability.size(); ++i) {
    if (!pair.counts(i)) continue;
    const SeenShare pixel{1, double(probability[i]) > vision::kSeenProbability ? 1u : 0u};
    quality.all.add(pixel);
    if (pair.objects) quality.objects[(*pair.objects)[i]].add(pixel);
  }
  return quality;
}

}  // namespace

void AnimationQuality::add(const AnimationQuality& frame) {
  all.add(frame.all);
  for (const auto& [id, share] : frame.objects) objects[id].add(share);
}

double shared_exposure_stops(const ComparedInputs& inputs) {
  std::array<double, 2> stops{};
  parallel_chunks(2, 1, [&](std::size_t i, std::size_t) {
    stops[i] = auto_exposure_stops(*(i ? inputs.reference : inputs.test).image, inputs.layer);
  });
  return 0.5 * (stops[0] + stops[1]);
}

JudgedFrame judge_frame(const Compared& pair, const PixelFlow* flow, const VisionOptions& options,
                        const std::string& name) {
  check_colour(pair, name);
  if (flow && (flow->width != pair.width || flow->height != pair.height))
    throw InputError(name + ": " + std::to_string(pair.width) + "x" + std::to_string(pair.height) +
                     " pixels, but its flow has " + std::to_string(flow->width) + "x" + std::to_string(flow->height) +
                     "; give the flow of this frame");
  const double exposure = std::exp2(options.exposure_stops), ppd = options.display.pixels_per_degree;
  const double share = options.of_either ? 0.5 + 0.5 * std::numbers::sqrt2 / 2 : 1;
  const vision::DisplayedPair shown{pair.width, pair.height, shown_luminance(pair, share, options.display, exposure),
                                    shown_luminance(pair, 1 - share, options.display, exposure), pair.counted};
  const std::vector<float> speed =
      flow ? vision::display_speed(*flow, ppd, options.frames_per_second) : std::vector<float>();
  vision::Detection detection = vision::detection_map(shown, speed, {ppd, options.gaze, options.display.distance});
  JudgedFrame judged{count_seen(pair, detection.probability), {}};
  judged.quality.adaptation_luminance = detection.adaptation_luminance;
  judged.probability = std::move(detection.probability);
  return judged;
}

std::vector<float> error_probability(const std::array<std::vector<float>, 3>& picture,
                                     const std::array<std::vector<float>, 3>& error,
                                     const std::vector<std::uint8_t>& counted, const PixelFlow& flow,
                                     VisionOptions options) {
  std::array<Image, 3> images;  // the picture, the picture plus and minus half the error
  for (std::size_t k = 0; k < images.size(); ++k) {
    images[k].width = flow.width;
    images[k].height = flow.height;
    const float share = k == 0 ? 0 : k == 1 ? 0.5f : -0.5f;
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<float>& values = images[k].add(std::string(1, "RGB"[c])).values;
      for (std::size_t p = 0; p < values.size(); ++p) values[p] = picture[c][p] + share * error[c][p];
    }
  }
  options.exposure_stops = auto_exposure_stops(images[0], "");
  Compared pair;
  pair.width = flow.width;
  pair.height = flow.height;
  pair.channels = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    pair.test.push_back(&images[1].channels[c].values);
    pair.reference.push_back(&images[2].channels[c].values);
  }
  pair.counted = counted;
  return judge_frame(pair, &flow, options, "").probability;
}

Image probability_image(const JudgedFrame& judged, int width, int height) {
  Image image;
  image.width = width;
  image.height = height;
  image.add("P").values = judged.probability;
  return image;
}

Picture heat_map(const JudgedFrame& judged, const Image& frame, const PreviewOptions& preview) {
  Picture picture = make_picture(frame, preview);
  for (std::size_t i = 0; i < judged.probability.size(); ++i) {
    std::uint8_t* pixel = &picture.rgb[3 * i];
    const double grey = 0.7 * (0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2]),
                 p = double(judged.probability[i]);
    // Yellow up to P = 1/2, red from the probability at which a difference counts as seen.
    const double green = 255 * std::clamp((vision::kSeenProbability - p) / (vision::kSeenProbability - 0.5), 0.0, 1.0);
    const double heat[3] = {255, green, 0};
    for (int c = 0; c < 3; ++c) pixel[c] = std::uint8_t(std::lround((1 - p) * grey + p * heat[c]));
  }
  return picture;
}

}  // namespace tempolux
