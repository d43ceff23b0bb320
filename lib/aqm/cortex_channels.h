// lib/aqm/cortex_channels.h -- pictures taken apart into the channels of the visual cortex, each at a
// resolution of its own.
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <vector>

#include "lib/aqm/fourier.h"
#include "lib/aqm/vision_model.h"

namespace tempolux::vision {

/// The grid on which a picture of width x height pixels is transformed: its borders are reflected, over 32
/// pixels or more on each side together, which is what the lowest band reaches, up to a size that is
/// transformed fast. The far half of what is added lies before column and row 0, as the transform's period
/// has it.
struct ChannelGrid {
  int width = 0, height = 0;                ///< of the picture
  int padded_width = 0, padded_height = 0;  ///< multiples of 8

  ChannelGrid(int width, int height);
  std::size_t padded_count() const { return std::size_t(padded_width) * std::size_t(padded_height); }
  /// A band is sampled at every `step`-th pixel: its upper edge lies at or below Nyquist's frequency of those
  /// samples, 1 / (2 step) c/px, or it is sampled at all pixels. (Bands 1 and 2 at every second pixel, which
  /// one orientation as complex numbers allows, would be a fifth faster, but the threshold of a dot would
  /// then depend by 19 % on its place.)
  static int step(int band);
  /// Samples of a band that lie in the picture, and one beyond where there is one.
  int columns(int band) const;
  int rows(int band) const;
};

/// Spectrum of a picture, in the layout of FourierTransform::forward over the padded grid. `values` are width
/// x height.
FourierArray<std::complex<float>> padded_spectrum(const FourierTransform& transform, const ChannelGrid& grid,
                                                  const std::vector<float>& values);

/// Band and orientation, 1 to kOrientations; 0 for the base band, which has none.
struct ChannelName {
  int band = 0, orientation = 0;
};
/// All 31, fine bands first, the base band last.
std::vector<ChannelName> channel_names();

/// The same channel of two pictures, sampled over the whole padded grid, padded_width / step columns.
///
/// An oriented channel is complex: its real part is what the filters of the cortex transform leave of the
/// picture, its imaginary part the same shifted by a quarter of a period (one half plane of the spectrum,
/// doubled), so that its magnitude is the local amplitude, whatever the phase. The base band is real.
struct ChannelPair {
  FourierArray<std::complex<float>> first, second;
};

/// Takes channels out of two spectra. Each frequency is weighted by the channel's filter and by the
/// sensitivity to what stands still, over its largest product in the band: within a band an eye sees what it
/// sees of each frequency, nothing of frequency 0.
class ChannelFilters {
 public:
  /// `still`: sensitivity to a frequency, cpd, of what stands still.
  ChannelFilters(const ChannelGrid& grid, double pixels_per_degree, const std::function<double(double)>& still);
  /// What a channel is to be multiplied by so that a grating of band_frequency() that moves at `speed` deg/s
  /// gives contrast times sensitivity. Other frequencies of the band change with speed as that one does.
  double sensitivity(int band, double speed) const;
  ChannelPair channel(const FourierTransform& transform, ChannelName name,
                      const FourierArray<std::complex<float>>& first,
                      const FourierArray<std::complex<float>>& second) const;

 private:
  struct Lobe;
  float radial(int band, double frequency) const;
  ChannelGrid grid_;
  double pixels_per_degree_;
  std::vector<std::vector<float>> radial_;  ///< by band - 1, over frequency
  std::array<double, kBands> most_{};       ///< largest product of filter and sensitivity, by band - 1
};

}  // namespace tempolux::vision
