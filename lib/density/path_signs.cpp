#include "lib/density/path_signs.h"

#include <bit>

#include "lib/core/random.h"

namespace tempolux {

std::vector<std::int8_t> path_signs(std::span<const formats::Photon> photons, const PhotonIndex& index) {
  if (index.size() == 0) return {};
  std::vector<std::int8_t> by_photon(photons.size()), signs(index.size());
  for (std::size_t i = 0; i < photons.size(); ++i) {
    const auto bits = [&](std::size_t axis) {
      return std::uint64_t(std::bit_cast<std::uint32_t>(photons[i].position[axis]));
    };
    const bool goes_on = i > 0 && photons[i].bounce > photons[i - 1].bounce;
    by_photon[i] = goes_on                                               ? by_photon[i - 1]
                   : mix64(mix64(bits(0) << 32 | bits(1)) + bits(2)) & 1 ? std::int8_t(1)
                                                                         : std::int8_t(-1);
  }
  for (std::size_t i = 0; i < signs.size(); ++i) signs[i] = by_photon[index.source(i)];
  return signs;
}

}  // namespace tempolux
