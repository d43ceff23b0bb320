// formats/photons/summary.h -- statistics of a photon map, for people and for checks.
#pragma once

#include <array>
#include <cstdint>
#include <map>

#include "formats/photons/photons.h"

namespace tempolux::formats {

/// Number and flux of some photons.
struct PhotonShare {
  std::uint64_t count = 0;
  std::array<double, 3> flux{};  ///< W: sum in file order
};

struct PhotonSummary {
  PhotonShare all;
  std::array<PhotonShare, kPathKinds> by_kind;  ///< by PathKind
  std::map<std::uint16_t, PhotonShare> by_object;
  std::array<double, 3> bounds_min{}, bounds_max{};  ///< m, world space; min > max if there are no photons
  std::array<double, 3> mean_flux{};                 ///< W per photon and channel; 0 if there are no photons
  double largest_flux = 0;                           ///< W: largest |flux| of any photon and channel
  std::uint64_t largest_bounce = 0;
};

/// Reads all remaining blocks. Throws as the reader does. Memory: one block.
PhotonSummary summarise(PhotonReader& reader);

}  // namespace tempolux::formats
