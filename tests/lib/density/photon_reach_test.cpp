// photon_reach() on lattices, whose neighbours lie at known distances.
#include "lib/density/photon_reach.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

using formats::Photon;

/// A square lattice of 200 x 200 photons on the plane y = height, with this spacing [m] from x = first on. Fewer than 5
/// % of them are at its border.
void add_lattice(float first, float height, float spacing, Vec3 normal, std::vector<Photon>& photons) {
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) {
      Photon photon{.position = {first + spacing * float(i), height, spacing * float(j)}, .flux = {1, 1, 1}};
      photon.normal = formats::encode_normal({normal.x, normal.y, normal.z});
      photon.kind = formats::PathKind::indirect;
      photons.push_back(photon);
    }
}

const Vec3 kUp{0, 1, 0};

// A photon of the lattice has four neighbours at distance a and four at sqrt(2) a.
TEST(PhotonReach, IsTheDistanceOfTheKthNeighbourWithoutThePhotonItself) {
  std::vector<Photon> photons;
  add_lattice(0, 0, 0.5f, kUp, photons);
  const PhotonIndex index(photons);
  EXPECT_EQ(photon_reach(index, 4), 0.5f);
  EXPECT_FLOAT_EQ(photon_reach(index, 5), 0.5f * std::sqrt(2.0f));
  EXPECT_FLOAT_EQ(photon_reach(index, 8), 0.5f * std::sqrt(2.0f));
}

// Sheets a fifth of a spacing above and below are two spacings away in the metric of the ellipsoid, and photons of the
// other side do not count at any distance.
TEST(PhotonReach, LeavesOutParallelSheetsAndTheOtherSide) {
  std::vector<Photon> photons;
  add_lattice(0, 0, 0.5f, kUp, photons);
  add_lattice(0, 0.1f, 0.5f, kUp, photons);
  add_lattice(0, 0.001f, 0.5f, -kUp, photons);
  EXPECT_EQ(photon_reach(PhotonIndex(photons), 4), 0.5f);
}

TEST(PhotonReach, MeasuresAtTheSelectedPhotonsOrAtAllIfNoneIsSelected) {
  std::vector<Photon> photons;
  add_lattice(0, 0, 0.5f, kUp, photons);
  add_lattice(1000, 0, 0.125f, kUp, photons);
  const PhotonIndex index(photons);
  EXPECT_EQ(photon_reach(index, 4, [](Vec3 p) { return p.x >= 1000; }), 0.125f);
  EXPECT_EQ(photon_reach(index, 4, [](Vec3 p) { return p.x > 5000; }), photon_reach(index, 4));
  EXPECT_EQ(photon_reach(index, 4), 0.5f) << "half of the photons have the larger spacing";
}

TEST(PhotonReach, OfNoPhotonIsZero) { EXPECT_EQ(photon_reach(PhotonIndex(), 4), 0); }

}  // namespace
}  // namespace tempolux
