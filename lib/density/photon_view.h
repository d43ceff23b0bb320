// lib/density/photon_view.h -- photons in memory with, if their file has them, the directions they came from.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/octahedral.h"
#include "formats/photons/photons.h"
#include "lib/core/arrays.h"

namespace tempolux {

/// A view of photons, which must outlive the view. If directions are stored (one per photon), the flux of caustic
/// photons excludes normal maps and coats, and the reader applies them (received_share). Without directions the flux is
/// the flux that the Lambert lobe receives (formats/photons/photons.md, section 5).
struct PhotonView {
  std::span<const formats::Photon> photons;
  std::span<const std::array<std::uint16_t, 2>> directions;  ///< wi in octahedral coding; may be empty

  PhotonView() = default;
  PhotonView(std::span<const formats::Photon> all) : photons(all) {}
  PhotonView(const std::vector<formats::Photon>& all) : photons(all) {}
  PhotonView(const formats::PhotonBlock& block) : photons(block.photons), directions(block.directions) {}
  PhotonView(const formats::PhotonMap& map) : photons(map.photons), directions(map.directions) {}

  bool directed() const { return !directions.empty(); }
  /// wi of photon i, if directions are stored.
  std::optional<Vec3> direction(std::size_t i) const {
    if (!directed()) return std::nullopt;
    return vec_of(formats::decode_normal(directions[i]));
  }
};

/// Appends `photon` to a block, with the direction of photon i of `from`, if directions are stored.
inline void append(const PhotonView& from, std::size_t i, const formats::Photon& photon, formats::PhotonBlock& to) {
  to.photons.push_back(photon);
  if (from.directed()) to.directions.push_back(from.directions[i]);
}

}  // namespace tempolux
