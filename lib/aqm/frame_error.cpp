// lib/aqm/frame_error.cpp -- sums errors over pixels and computes figures from the sums.
#include "lib/aqm/frame_error.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/statistics.h"

namespace tempolux {
namespace {

/// One pixel's contribution, each a mean over channels.
struct PixelError {
  double squared = 0, difference = 0, reference = 0, scale_squared = 0, half_difference_squared = 0;
};

PixelError pixel_error(const Compared& pair, std::size_t i) {
  PixelError sum;
  for (std::size_t c = 0; c < pair.test.size(); ++c) {
    const double x = (*pair.test[c])[i], r1 = (*pair.reference[c])[i];
    const double r2 = pair.halves() ? double((*pair.second[c])[i]) : r1;
    const double r = 0.5 * (r1 + r2), half = 0.5 * (r1 - r2), scale = pair.scale_at(c, i);
    sum.squared += (x - r1) * (x - r2);
    sum.difference += x - r;
    sum.reference += r;
    sum.scale_squared += scale * scale;
    sum.half_difference_squared += half * half;
  }
  const double each = 1.0 / double(pair.test.size());
  return {sum.squared * each, sum.difference * each, sum.reference * each, sum.scale_squared * each,
          sum.half_difference_squared * each};
}

/// Mean of r over the pixels that count, added block by block like the other sums.
double mean_reference(const Compared& pair, const BlockGrid& grid) {
  std::vector<BlockQuotient> blocks(grid.count());
  for (int y = 0; y < pair.height; ++y)
    for (int x = 0; x < pair.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(pair.width) + std::size_t(x);
      if (!pair.counts(i)) continue;
      BlockQuotient& block = blocks[grid.block_of(x, y)];
      block.numerator += pixel_error(pair, i).reference;
      block.denominator += 1;
    }
  const auto mean = quotient_of_sums(blocks);
  return mean ? mean->value : 0;
}

void note_extremes(const Compared& pair, int frame, int x, int y, ErrorSums& sums) {
  const std::size_t i = std::size_t(y) * std::size_t(pair.width) + std::size_t(x);
  for (std::size_t c = 0; c < pair.test.size(); ++c) {
    const double r = pair.reference_at(c, i), difference = double((*pair.test[c])[i]) - r;
    sums.peak = std::max(sums.peak, r);
    if (std::abs(difference) > std::abs(sums.largest.value)) sums.largest = {difference, x, y, frame, pair.channels[c]};
  }
}

void add_block(ErrorSums::Block& to, const ErrorSums::Block& from) {
  to.pixels += from.pixels;
  to.squared += from.squared;
  to.relative += from.relative;
  to.difference += from.difference;
  to.reference += from.reference;
}

/// Quotient of sums over the blocks with pixels.
std::optional<Estimate> over_blocks(const std::vector<ErrorSums::Block>& blocks, double ErrorSums::Block::*numerator,
                                    double ErrorSums::Block::*denominator) {
  std::vector<BlockQuotient> used;
  for (const ErrorSums::Block& block : blocks)
    if (block.pixels > 0) used.push_back({block.*numerator, block.*denominator});
  return quotient_of_sums(used);
}

std::vector<ObjectError> object_errors(const ErrorSums& sums, double squared_total, std::uint64_t min_pixels) {
  std::vector<ObjectError> objects;
  for (const auto& [id, by_block] : sums.objects) {
    std::vector<ErrorSums::Block> blocks;
    ErrorSums::Block total;
    for (const auto& [index, block] : by_block) {
      blocks.push_back(block);
      add_block(total, block);
    }
    ObjectError object;
    object.id = id;
    object.pixels = std::uint64_t(total.pixels);
    object.bias = over_blocks(blocks, &ErrorSums::Block::difference, &ErrorSums::Block::reference);
    object.share_of_squared_error = squared_total > 0 ? total.squared / squared_total : 0;
    object.few_pixels = object.pixels < min_pixels;
    objects.push_back(object);
  }
  return objects;
}

}  // namespace

double SquaredFigure::root() const { return squared.value > 0 ? std::sqrt(squared.value) : 0; }

std::optional<double> SquaredFigure::root_standard_error() const {
  if (!squared.standard_error || squared.value <= 0) return std::nullopt;
  return *squared.standard_error / (2 * root());
}

bool SquaredFigure::resolved() const {
  return squared.value > 0 && squared.standard_error && *squared.standard_error * kCertain < squared.value;
}

ErrorSums sum_errors(const Compared& pair, int frame) {
  ErrorSums sums;
  sums.grid = BlockGrid(pair.width, pair.height);
  sums.blocks.resize(sums.grid.count());
  sums.halves = pair.halves();
  sums.largest.frame = frame;
  const double softening = 0.1 * mean_reference(pair, sums.grid);
  sums.relative_known = softening * softening > 0;

  for (int y = 0; y < pair.height; ++y)
    for (int x = 0; x < pair.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(pair.width) + std::size_t(x);
      if (!pair.counts(i)) continue;
      const PixelError error = pixel_error(pair, i);
      ErrorSums::Block pixel{1, error.squared, 0, error.difference, error.reference};
      if (sums.relative_known) pixel.relative = error.squared / (error.scale_squared + softening * softening);
      const std::size_t block = sums.grid.block_of(x, y);
      add_block(sums.blocks[block], pixel);
      if (pair.objects) add_block(sums.objects[(*pair.objects)[i]][block], pixel);
      sums.half_difference_squared += error.half_difference_squared;
      note_extremes(pair, frame, x, y, sums);
    }
  return sums;
}

void add_errors(ErrorSums& total, const ErrorSums& frame) {
  TEMPOLUX_CHECK(total.grid == frame.grid && total.halves == frame.halves);
  for (std::size_t i = 0; i < total.blocks.size(); ++i) add_block(total.blocks[i], frame.blocks[i]);
  for (const auto& [id, by_block] : frame.objects)
    for (const auto& [index, block] : by_block) add_block(total.objects[id][index], block);
  total.relative_known = total.relative_known && frame.relative_known;
  total.half_difference_squared += frame.half_difference_squared;
  total.peak = std::max(total.peak, frame.peak);
  if (std::abs(frame.largest.value) > std::abs(total.largest.value)) total.largest = frame.largest;
}

FrameError figures_of(const ErrorSums& sums, std::uint64_t min_object_pixels) {
  using Block = ErrorSums::Block;
  Block total;
  for (const Block& block : sums.blocks) add_block(total, block);
  TEMPOLUX_CHECK(total.pixels > 0);

  FrameError error;
  error.pixels = std::uint64_t(total.pixels);
  error.halves = sums.halves;
  error.squared_error.squared = over_blocks(sums.blocks, &Block::squared, &Block::pixels).value_or(Estimate{});
  error.mean_difference = over_blocks(sums.blocks, &Block::difference, &Block::pixels).value_or(Estimate{});
  error.mean_reference = total.reference / total.pixels;
  error.mean_test = error.mean_reference + error.mean_difference.value;
  if (sums.relative_known) error.relative_squared_error = over_blocks(sums.blocks, &Block::relative, &Block::pixels);
  error.bias = over_blocks(sums.blocks, &Block::difference, &Block::reference);
  const double squared = error.squared_error.squared.value;
  if (sums.peak > 0 && squared > 0) error.psnr_db = 10 * std::log10(sums.peak * sums.peak / squared);
  error.largest = sums.largest;
  if (sums.halves) error.reference_noise = std::sqrt(sums.half_difference_squared / total.pixels);
  error.objects = object_errors(sums, total.squared, min_object_pixels);
  return error;
}

SquaredFigure noise_of_mean(const FrameError& a_against_b) {
  Estimate squared = a_against_b.squared_error.squared;
  squared.value /= 4;
  if (squared.standard_error) *squared.standard_error /= 4;
  return {squared};
}

void FlickerMeter::add(const Compared& frame) {
  const std::size_t pixels = std::size_t(frame.width) * std::size_t(frame.height), channels = frame.test.size();
  const bool first = previous_.empty();
  if (first) {
    grid_ = BlockGrid(frame.width, frame.height);
    blocks_.resize(grid_.count());
    previous_.resize(pixels * channels);
    previous_second_.resize(frame.halves() ? pixels * channels : 0);
  }
  TEMPOLUX_CHECK(previous_.size() == pixels * channels && previous_second_.empty() != frame.halves());

  for (std::size_t i = 0; i < pixels; ++i) {
    double product = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const double x = (*frame.test[c])[i], d1 = x - double((*frame.reference[c])[i]);
      const double d2 = frame.halves() ? x - double((*frame.second[c])[i]) : d1;
      double& before1 = previous_[c * pixels + i];
      double& before2 = frame.halves() ? previous_second_[c * pixels + i] : before1;
      product += (d1 - before1) * (d2 - before2);
      before1 = d1;
      before2 = d2;
    }
    if (first || !frame.counts(i) || (!counted_.empty() && !counted_[i])) continue;
    const int width = frame.width;
    BlockQuotient& block = blocks_[grid_.block_of(int(i % std::size_t(width)), int(i / std::size_t(width)))];
    block.numerator += product / double(channels);
    block.denominator += 1;
  }
  counted_ = frame.counted;
  if (!first) ++pairs_;
}

std::optional<SquaredFigure> FlickerMeter::result() const {
  std::vector<BlockQuotient> used;
  for (const BlockQuotient& block : blocks_)
    if (block.denominator > 0) used.push_back(block);
  if (pairs_ == 0 || used.empty()) return std::nullopt;
  return SquaredFigure{*quotient_of_sums(used)};
}

}  // namespace tempolux
