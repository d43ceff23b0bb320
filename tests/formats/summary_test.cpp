#include "formats/photons/summary.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace tempolux::formats {
namespace {

/// A file of these photons that goes away with the object.
class PhotonFile {
 public:
  explicit PhotonFile(const std::vector<Photon>& photons)
      : path_(testing::TempDir() + "summary." + std::to_string(getpid()) + "." + std::to_string(count_++)) {
    std::ofstream file(path_, std::ios::binary);
    PhotonHeader header;
    header.origin = {100, 0, 0};
    PhotonWriter writer(
        [&](const void* data, std::size_t size) { file.write(static_cast<const char*>(data), std::streamsize(size)); },
        header);
    for (const Photon& photon : photons) writer.write(PhotonBlock{0, {photon}, {}, {}});  // a block for each
    writer.finish({});
  }
  ~PhotonFile() { std::remove(path_.c_str()); }
  const std::string& path() const { return path_; }

 private:
  static inline int count_ = 0;
  std::string path_;
};

Photon photon(float x, float flux, PathKind kind, std::uint16_t object) {
  Photon result;
  result.position = {x, 0, 0};
  result.flux = {flux, 0, 2 * flux};
  result.kind = kind;
  result.object = object;
  result.bounce = std::uint8_t(object);
  return result;
}

const std::vector<Photon> kThree{photon(1, 2, PathKind::direct, 4), photon(-1, 1, PathKind::caustic, 4),
                                 photon(5, 0.5f, PathKind::direct, 9)};

TEST(PhotonSummary, CountsByKindAndObjectInWorldSpace) {
  const PhotonFile file(kThree);
  PhotonReader reader(file.path());
  const PhotonSummary summary = summarise(reader);
  EXPECT_EQ(summary.all.count, 3u);
  EXPECT_EQ(summary.all.flux, (std::array<double, 3>{3.5, 0, 7}));
  EXPECT_EQ(summary.by_kind[0].count, 2u);
  EXPECT_EQ(summary.by_kind[0].flux[0], 2.5);
  EXPECT_EQ(summary.by_kind[1].flux[2], 2);
  ASSERT_EQ(summary.by_object.size(), 2u);
  EXPECT_EQ(summary.by_object.at(4).flux[0], 3);
  EXPECT_EQ(summary.bounds_min[0], 99);
  EXPECT_EQ(summary.bounds_max[0], 105);
  EXPECT_EQ(summary.largest_flux, 4);
  EXPECT_EQ(summary.largest_bounce, 9u);
  EXPECT_DOUBLE_EQ(summary.mean_flux[0], 3.5 / 3);
}

TEST(PhotonSummary, OfNoPhotonsIsZero) {
  const PhotonFile file({});
  PhotonReader reader(file.path());
  const PhotonSummary summary = summarise(reader);
  EXPECT_EQ(summary.all.count, 0u);
  EXPECT_EQ(summary.mean_flux[0], 0);
}

}  // namespace
}  // namespace tempolux::formats
