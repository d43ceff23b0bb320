// lib/aqm/frame_error.h -- error of a frame: RMSE, relMSE, bias, PSNR, in total and by object.
//
// x is the test frame, r the reference. If the reference has two independent halves r1, r2, every square (x-r)^2 is
// replaced by the product (x-r1)(x-r2). Its expectation over the reference's noise is the squared error against the
// noiseless reference: no noise floor. It may be negative if the error is smaller than the reference's noise. With a
// single reference the squares include its noise. Sums are doubles in pixel order: the same numbers for any number of
// threads.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lib/aqm/block_sums.h"
#include "lib/aqm/compared.h"

namespace tempolux {

/// A mean square and its root.
struct SquaredFigure {
  Estimate squared;  ///< may be negative with halves
  /// Root of the mean square; 0 if the mean square is not positive.
  double root() const;
  /// standard_error / (2 root); empty if the root is 0 or the standard error is unknown.
  std::optional<double> root_standard_error() const;
  /// True if the standard error of the mean square is below a third of it: the figure may then be quoted.
  bool resolved() const;
};

/// The largest difference of x and r, over all channels.
struct LargestDifference {
  double value = 0;             ///< x - r, signed
  int x = 0, y = 0, frame = 0;  ///< column and row from the top left
  std::string channel;
};

struct ObjectError {
  std::uint32_t id = 0;               ///< id.object
  std::uint64_t pixels = 0;           ///< over all frames
  std::optional<Estimate> bias;       ///< mean(x-r)/mean(r) over its pixels; empty if mean(r) = 0
  double share_of_squared_error = 0;  ///< of the image's sum; 0 if the sum is not positive
  bool few_pixels = false;            ///< fewer pixels than requested: its figures are noise
};

/// All figures of a frame, or of a sequence as a whole. Units are the layer's (radiance), squared if the name says so.
/// A figure that does not exist is missing, never NaN.
struct FrameError {
  std::uint64_t pixels = 0;  ///< that count, over all frames
  bool halves = false;
  SquaredFigure squared_error;  ///< mean over pixels and channels of (x-r)^2
  /// Mean over pixels of |x-r|^2 / (|r|^2 + (0.1 mean r)^2), where |.|^2 is the mean over channels and mean r the mean
  /// over the frame. In the denominator r is the mean of the halves. Its noise changes the figure by up to 6 s^4, with
  /// s the noise over sqrt(r^2 + (0.1 mean r)^2): set Compared::smooth if that matters. Empty if mean r is 0 (black
  /// reference).
  std::optional<Estimate> relative_squared_error;
  std::optional<Estimate> bias;   ///< mean(x-r)/mean(r); empty if mean r is 0
  std::optional<double> psnr_db;  ///< 10 log10(peak^2 / mean square), peak the largest r;
                                  ///< nothing if either is not positive
  Estimate mean_difference;       ///< mean(x-r)
  double mean_test = 0, mean_reference = 0;
  LargestDifference largest;
  std::optional<double> reference_noise;  ///< RMS of (r1-r2)/2: the noise of the mean of the halves
  std::vector<ObjectError> objects;       ///< by id; empty without id.object
};

/// Sums over a frame by block. Frames of one size add up to a sequence, whose relative error is the mean over frames. A
/// block is the same block in all frames, so errors that persist over frames do not count as independent.
struct ErrorSums {
  struct Block {
    double pixels = 0, squared = 0, relative = 0, difference = 0, reference = 0;
  };
  BlockGrid grid;
  bool halves = false, relative_known = true;
  std::vector<Block> blocks;
  std::map<std::uint32_t, std::map<std::size_t, Block>> objects;  ///< by id and block
  double half_difference_squared = 0;  ///< sum over pixels of mean over channels of ((r1-r2)/2)^2
  double peak = 0;                     ///< largest r
  LargestDifference largest;
};

/// Sums of one frame.
ErrorSums sum_errors(const Compared& pair, int frame);

/// Adds the sums of another frame of the same size.
void add_errors(ErrorSums& total, const ErrorSums& frame);

/// Computes figures from sums; objects of fewer than min_object_pixels pixels are marked.
FrameError figures_of(const ErrorSums& sums, std::uint64_t min_object_pixels);

/// RMS of the noise in the mean (a+b)/2 of two independent halves a and b of one image: RMS(a-b)/2, since the variance
/// of a-b is four times the variance of the mean. `a_against_b` is the comparison of the frame a with the reference b.
SquaredFigure noise_of_mean(const FrameError& a_against_b);

/// Flicker of a sequence: RMS over pixels and frames of (x_t - x_{t-1}) - (r_t - r_{t-1}), with halves as above; t-1 is
/// the frame added before. A pixel counts if it counts in both frames.
class FlickerMeter {
 public:
  /// Adds the next frame; all frames have one size and layer.
  void add(const Compared& frame);
  /// Empty before the second frame.
  std::optional<SquaredFigure> result() const;

 private:
  BlockGrid grid_;
  std::vector<BlockQuotient> blocks_;
  std::vector<double> previous_, previous_second_;  ///< x - r1 and x - r2 of the previous frame, by channel and pixel
  std::vector<std::uint8_t> counted_;
  int pairs_ = 0;
};

}  // namespace tempolux
