// lib/material/tables/spectrum_integrals.h -- the colours of single wavelengths, and how often each is drawn.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lib/material/dispersion.h"

namespace tempolux::integrals {

/// The CIE 1931 curves [1] at a wavelength [nm]: the fit by several Gaussians of Wyman, Sloan & Shirley, "Simple
/// Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013.
inline std::array<double, 3> cie_xyz(double nm) {
  const auto lobe = [&](double height, double middle, double left, double right) {
    const double t = (nm - middle) * (nm < middle ? left : right);
    return height * std::exp(-0.5 * t * t);
  };
  return {lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(-0.065, 501.1, 0.0490, 0.0382),
          lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
          lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)};
}

/// The same in linear Rec. 709.
inline std::array<double, 3> cie_rgb(double nm) {
  const auto [x, y, z] = cie_xyz(nm);
  return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
          0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

/// The table of dispersion.h.
struct Spectrum {
  std::vector<double> wavelength, color;

  Spectrum() {
    constexpr double kFirst = 390, kLast = 675, kStep = 0.05;  // nm; beyond, the fit has green where there is none
    constexpr int kCount = int((kLast - kFirst) / kStep + 0.5);
    const auto at = [&](int i) { return kFirst + (i + 0.5) * kStep; };
    std::array<double, 3> total{};
    for (int i = 0; i < kCount; ++i)
      for (std::size_t c = 0; c < 3; ++c) total[c] += std::max(0.0, cie_rgb(at(i))[c]);
    const auto channel = [&](double nm, std::size_t c) { return std::max(0.0, cie_rgb(nm)[c]) / total[c]; };
    double drawn = 0;  // probability of wavelengths below the current one
    for (int i = 0, k = 0; k <= spectrum_table::kSteps && i < kCount; ++i) {
      const double share = (channel(at(i), 0) + channel(at(i), 1) + channel(at(i), 2)) / 3;
      for (; k <= spectrum_table::kSteps && double(k) / spectrum_table::kSteps <= drawn + share; ++k) {
        wavelength.push_back(at(i));
        for (std::size_t c = 0; c < 3; ++c) color.push_back(channel(at(i), c) / share);
      }
      drawn += share;
    }
    while (wavelength.size() <= spectrum_table::kSteps) {  // rounding of the last sum
      wavelength.push_back(wavelength.back());
      color.insert(color.end(), color.end() - 3, color.end());
    }
    make_white();
  }

 private:
  /// Scales each channel so that its mean, with linear steps between the nodes, is 1.
  void make_white() {
    for (std::size_t c = 0; c < 3; ++c) {
      double mean = 0;
      for (std::size_t k = 0; k < wavelength.size(); ++k)
        mean += color[3 * k + c] * (k == 0 || k + 1 == wavelength.size() ? 0.5 : 1) / spectrum_table::kSteps;
      for (std::size_t k = 0; k < wavelength.size(); ++k) color[3 * k + c] /= mean;
    }
  }
};

}  // namespace tempolux::integrals
