#include "lib/density/path_signs.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

/// Paths of 1, 2 and 3 photons in turn, with ascending bounces; only every second photon is of the kind of the index.
/// The signs of 3000 paths add up to 0 within 3 sqrt(3000) = 164 with a probability of .997.
TEST(PathSigns, PhotonsOfAPathHaveOneSignAndPathsHaveRandomOnes) {
  std::vector<formats::Photon> photons;
  std::vector<std::uint32_t> path_of;
  for (std::uint32_t path = 0; path < 3000; ++path)
    for (std::uint32_t k = 0; k <= path % 3; ++k) {
      formats::Photon& photon = photons.emplace_back();
      photon.position = {float(path), float(k), 0};
      photon.flux = {1, 1, 1};
      photon.kind = photons.size() % 2 ? formats::PathKind::indirect : formats::PathKind::caustic;
      photon.bounce = std::uint8_t(1 + path % 2 + k);
      path_of.push_back(path);
    }
  const PhotonIndex all(photons), indirect(photons, kind_bit(formats::PathKind::indirect));
  const std::vector<std::int8_t> signs = path_signs(photons, all), some = path_signs(photons, indirect);
  std::vector<int> of_path(3000, 0);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    int& sign = of_path[path_of[all.source(i)]];
    if (sign == 0) sign = signs[i];
    EXPECT_EQ(signs[i], sign);
  }
  for (std::size_t i = 0; i < some.size(); ++i) EXPECT_EQ(some[i], of_path[path_of[indirect.source(i)]]);
  int sum = 0;
  for (const int sign : of_path) sum += sign;
  EXPECT_LT(std::abs(sum), 164);
}

}  // namespace
}  // namespace tempolux
