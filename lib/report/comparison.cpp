// lib/report/comparison.cpp -- collects frames into a comparison.
#include "lib/report/comparison.h"

#include <utility>

#include "formats/error.h"
#include "lib/core/check.h"

namespace tempolux {

namespace {

/// Objects of fewer pixels are marked: their bias is noise.
constexpr std::uint64_t kFewPixels = 64;

}  // namespace

void ComparisonBuilder::add(const Compared& pair, int frame, const std::string& name) {
  const bool first = !total_;
  if (!first &&
      (pair.width != comparison_.width || pair.height != comparison_.height || pair.channels != comparison_.channels))
    throw InputError(name + ": size or channels differ from those of the frame before; compare equal frames");
  comparison_.width = pair.width;
  comparison_.height = pair.height;
  comparison_.channels = pair.channels;

  ErrorSums sums = sum_errors(pair, frame);
  comparison_.frames.push_back({frame, figures_of(sums, kFewPixels), {}});
  if (first) total_ = std::move(sums);
  else add_errors(*total_, sums);
  flicker_.add(pair);
}

void ComparisonBuilder::add(const AnimationQuality& quality, const VisionOptions& options) {
  TEMPOLUX_CHECK(!comparison_.frames.empty());
  comparison_.viewing = options;
  comparison_.frames.back().quality = quality;
  if (!comparison_.quality) comparison_.quality.emplace();
  comparison_.quality->add(quality);
}

Comparison ComparisonBuilder::finish() {
  TEMPOLUX_CHECK(total_);
  comparison_.total = figures_of(*total_, kFewPixels);
  comparison_.flicker = flicker_.result();
  return std::move(comparison_);
}

}  // namespace tempolux
