// lib/aqm/cortex_channels.h -- splits pictures into the channels of the visual cortex, each sampled at its own
// resolution.
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <vector>

#include "lib/aqm/fourier.h"
#include "lib/aqm/vision_model.h"

namespace tempolux::vision {

/// The padded grid on which a picture of width x height pixels is transformed. The padding reflects the picture at its
/// borders, over at least 32 pixels on both sides together (the reach of the lowest band), up to a size with a fast
/// transform. The second half of the padding continues before column and row 0, since the transform is periodic.
struct ChannelGrid {
  int width = 0, height = 0;                ///< of the picture
  int padded_width = 0, padded_height = 0;  ///< multiples of 8

  ChannelGrid(int width, int height);
  std::size_t padded_count() const { return std::size_t(padded_width) * std::size_t(padded_height); }
  /// Distance of a band's samples in pixels: 1, or so that the band's upper edge is at most the samples' Nyquist
  /// frequency of 1 / (2 step) c/px. (Every second pixel for bands 1 and 2, which complex samples of one orientation
  /// allow, would be a fifth faster, but the threshold of a dot would vary by 19 % with its position.)
  static int step(int band);
  /// Columns of a band's samples inside the picture, and one more if there is one.
  int columns(int band) const;
  int rows(int band) const;
};

/// The spectrum of a picture over the padded grid, in the layout of FourierTransform::forward. `values` has width x
/// height elements.
FourierArray<std::complex<float>> padded_spectrum(const FourierTransform& transform, const ChannelGrid& grid,
                                                  const std::vector<float>& values);

/// Band and orientation, 1 to kOrientations; 0 for the base band, which has none.
struct ChannelName {
  int band = 0, orientation = 0;
};
/// All 31 channels: fine bands first, the base band last.
std::vector<ChannelName> channel_names();

/// One channel of two pictures, sampled over the whole padded grid, padded_width / step columns. The base band is
/// real.
/// An oriented channel is complex. Its spectrum is one half plane of the filtered picture's, doubled. So the real
/// part is the picture filtered by the cortex transform, the imaginary part is the same shifted by a quarter of a
/// period, and the magnitude is the local amplitude, whatever the phase.
struct ChannelPair {
  FourierArray<std::complex<float>> first, second;
};

/// Extracts channels from two spectra. The weight of a frequency is the channel's filter times the sensitivity to still
/// pictures, divided by the largest such product in the band. So the weights inside a band follow the eye's
/// sensitivity, and frequency 0 has weight 0.
class ChannelFilters {
 public:
  /// `still`: sensitivity of the eye to a frequency (cpd) of a still picture.
  ChannelFilters(const ChannelGrid& grid, double pixels_per_degree, const std::function<double(double)>& still);
  /// Factor for a channel. The channel's response to a grating of band_frequency() that moves at `speed` deg/s, times
  /// this factor, is the grating's contrast times the eye's sensitivity. Assumes that speed changes the sensitivity
  /// to all frequencies of a band by the same factor.
  double sensitivity(int band, double speed) const;
  ChannelPair channel(const FourierTransform& transform, ChannelName name,
                      const FourierArray<std::complex<float>>& first,
                      const FourierArray<std::complex<float>>& second) const;

 private:
  struct Lobe;
  float radial(int band, double frequency) const;
  ChannelGrid grid_;
  double pixels_per_degree_;
  std::vector<std::vector<float>> radial_;  ///< by band - 1, by frequency
  std::array<double, kBands> most_{};       ///< by band - 1: largest product of filter and sensitivity
};

}  // namespace tempolux::vision
