// Numbers of light paths of a photon map.
#include "lib/pilot/pilot_photons.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

/// If at least one path in 70 leaves a photon, the usual number. If fewer do, as many times more paths, but at most
/// 16 times; also if no path leaves a photon.
TEST(PhotonPaths, AreMoreWhereFewArrive) {
  EXPECT_EQ(photon_paths(1.0 / 70, 700'000), 700'000u);
  EXPECT_EQ(photon_paths(5.0 / 7, 700'000), 700'000u);
  EXPECT_EQ(photon_paths(1.0 / 280, 700'000), 2'800'000u);
  EXPECT_EQ(photon_paths(1.0 / 1400, 100'000), 1'600'000u);
  EXPECT_EQ(photon_paths(0, 700'000), 11'200'000u);
}

}  // namespace
}  // namespace tempolux
