// lib/report/comparison.h -- a comparison of frames as JSON for machines and as a table for people.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lib/aqm/animation_quality.h"
#include "lib/aqm/frame_error.h"
#include "lib/image/object_names.h"

namespace tempolux {

/// What the reference of a comparison is.
enum class ComparisonMode {
  one_reference,     ///< its noise is part of every square
  reference_halves,  ///< two independent halves: no noise floor
  own_halves         ///< test and reference are two halves of one image: their difference is its noise
};

/// A frame or a sequence against its reference: what formats/comparison/comparison.md describes.
struct Comparison {
  std::string command;                  ///< the tool's line of history
  std::string test;                     ///< file or pattern, as given
  std::vector<std::string> references;  ///< one or two
  std::string relative_to;              ///< file or pattern in relMSE's denominator; "": reference
  ComparisonMode mode = ComparisonMode::one_reference;
  std::string layer;  ///< "" is RGB
  std::vector<std::string> channels;
  int width = 0, height = 0;
  struct Frame {
    int frame = 0;
    FrameError error;
    std::optional<AnimationQuality> quality;  ///< AQM, where it was asked for
  };
  std::vector<Frame> frames;
  FrameError total;                         ///< over all frames
  std::optional<SquaredFigure> flicker;     ///< absent for one frame
  std::optional<AnimationQuality> quality;  ///< AQM over all frames
  std::optional<VisionOptions> viewing;     ///< who looked, where there is AQM
  std::string flow;                         ///< file or pattern; "": everything stood still
  ObjectNames object_names;                 ///< as the frames that were judged have them
};

/// Collects the frames of a comparison, one in memory at a time.
class ComparisonBuilder {
 public:
  /// `comparison` brings what is known before: command, names, mode, layer. Objects of fewer than
  /// min_object_pixels pixels are flagged.
  ComparisonBuilder(Comparison comparison, std::uint64_t min_object_pixels);
  /// Adds a frame. Throws InputError if its size or channels differ from those of the frames before.
  void add(const Compared& pair, int frame, const std::string& name);
  /// What objects of a frame are called.
  void add(const ObjectNames& names) { comparison_.object_names.insert(names.begin(), names.end()); }
  /// AQM of the frame added last, and under which options, the same for all frames.
  void add(const AnimationQuality& quality, const VisionOptions& options);
  /// Totals over the frames added, of which there must be one.
  Comparison finish();

 private:
  Comparison comparison_;
  std::uint64_t min_object_pixels_;
  std::optional<ErrorSums> total_;
  FlickerMeter flicker_;
};

/// The document of comparison.md. Equal comparisons give equal text.
std::string comparison_json(const Comparison& comparison);

/// A table with one line per frame, then the total, flicker, the worst objects, and what to keep in mind.
std::string comparison_text(const Comparison& comparison);

}  // namespace tempolux
