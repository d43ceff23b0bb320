// Smoke that nothing sees: a volume in another unit than metres is told, one that is seen or inside the scene is not.
#include "lib/scene/volumes.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

/// A camera at (0, 1, 5) that looks along -z; half its picture is as high as the distance times tan(.5) = .546.
PlacedCamera camera() {
  PlacedCamera placed;
  placed.camera.yfov_rad = 1;
  placed.scene_from_camera.translation = {0, 1, 5};
  return placed;
}

struct Case {
  const char* what;
  Box3d volume, scene;
  const char* says;  ///< "": nothing
};

const Box3d kRoom{{-2, 0, -2}, {2, 3, 2}}, kGround{{-100, 0, -100}, {100, 0, 100}};

const Case kCases[] = {
    {"smoke in a room", {{-1, 0, -1}, {1, 2, 1}}, kRoom, ""},
    {"a room full of fog, and beyond", {{-3, -1, -3}, {3, 4, 3}}, kRoom, ""},
    {"a plume over flat ground, in the picture", {{-1, 1, -20}, {1, 3, -18}}, kGround, ""},
    {"a lamp's smoke behind the camera, in the scene", {{0, 0.5, 9}, {1, 1, 10}}, kGround, ""},
    {"centimetres: a hundred times too large", {{-50, 50, -50}, {50, 150, 50}}, kRoom, "outside of the scene"},
    {"behind the camera and outside", {{0, 0, 20}, {1, 1, 21}}, kRoom, "outside of the scene"},
    {"in the picture, but ten diagonals away", {{-1, 0, -60}, {1, 2, -58}}, kRoom, "outside of the scene"},
    // 5 m away the picture is 5.46 m high; a five hundredth of it is 11 mm.
    {"a ball of 1 mm", {{0, 1, 0}, {0.0005, 1.0005, 0.0005}}, kRoom, "smaller than a pixel"},
    {"a ball of 20 mm", {{0, 1, 0}, {0.02, 1.02, 0.02}}, kRoom, ""},
    {"no voxels", {}, kRoom, ""},
};

// Seen to fail: nothing was said of smoke in centimetres.
TEST(Volumes, SmokeThatNothingSeesIsTold) {
  const std::vector<PlacedCamera> cameras{camera()};
  for (const Case& c : kCases) {
    const std::string why = why_unseen(c.volume, c.scene, cameras, {});
    if (*c.says) EXPECT_NE(why.find(c.says), std::string::npos) << c.what << ": " << why;
    else EXPECT_EQ(why, "") << c.what;
  }
  const std::string why = why_unseen(kCases[4].volume, kRoom, cameras, {});
  EXPECT_NE(why.find("they fill 100 x 100 x 100 m around (0, 100, 0), the scene 4 x 3 x 4 m around (0, 1.5, 0)"),
            std::string::npos)
      << why;
}

TEST(Volumes, TheOriginOfSceneSpaceDoesNotCount) {
  const Vec3d far{1e5, 0, 0};
  const Box3d volume{kCases[0].volume.lower + far, kCases[0].volume.upper + far};
  EXPECT_EQ(why_unseen(volume, {kRoom.lower + far, kRoom.upper + far}, std::vector{camera()}, far), "");
}

}  // namespace
}  // namespace tempolux
