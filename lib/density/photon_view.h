// lib/density/photon_view.h -- photons in memory and, if their file has them, the directions that they came from.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/photons/photons.h"

namespace tempolux {

/// What it was made of must outlive it. With directions (one for each photon) normal maps and coats are left out of the
/// flux of kind caustic, and who looks applies them (received_share); without, all carry what a Lambert lobe gets of it
/// (formats/photons/photons.md, section 5).
struct PhotonView {
  std::span<const formats::Photon> photons;
  std::span<const std::array<std::uint16_t, 2>> directions;  ///< octahedral wi; or none

  PhotonView() = default;
  PhotonView(std::span<const formats::Photon> all) : photons(all) {}
  PhotonView(const std::vector<formats::Photon>& all) : photons(all) {}
  PhotonView(const formats::PhotonBlock& block) : photons(block.photons), directions(block.directions) {}
  PhotonView(const formats::PhotonMap& map) : photons(map.photons), directions(map.directions) {}

  bool directed() const { return !directions.empty(); }
};

/// Appends photon i of `from`, changed to `photon`, with its direction.
inline void append(const PhotonView& from, std::size_t i, const formats::Photon& photon, formats::PhotonBlock& to) {
  to.photons.push_back(photon);
  if (from.directed()) to.directions.push_back(from.directions[i]);
}

}  // namespace tempolux
