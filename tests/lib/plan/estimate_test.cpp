// tests/lib/plan/estimate_test.cpp -- the arithmetic of estimates, against what is computed on paper.
#include "lib/plan/estimate.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

TEST(Estimate, APowerLawGoesThroughItsTwoPoints) {
  EXPECT_NEAR(power_law(10, 100, 20, 200, 80), 800, 1e-9);  // in proportion
  EXPECT_NEAR(power_law(10, 100, 20, 100, 80), 100, 1e-9);  // constant
  EXPECT_NEAR(power_law(10, 100, 20, 90, 80), 90, 1e-9);    // never falls
  EXPECT_NEAR(power_law(10, 1, 20, 100, 40), 400, 1e-9);    // never faster than the pixels
  EXPECT_EQ(power_law(10, 5, 20, 0, 40), 0);
  EXPECT_NEAR(power_law(10, 0, 20, 7, 40), 14, 1e-9);
}

TEST(Estimate, TextHasAllStagesAndTheirSums) {
  const std::string text = estimate_text({{"photon-trace", 2, 1.1, 1e6}, {"frame-render", 4, 2.1, 5e6}}, 2);
  EXPECT_NE(text.find("photon-trace"), std::string::npos);
  EXPECT_NE(text.find("10.6                 22.0 MB"), std::string::npos) << text;  // 2 x 1.1 + 4 x 2.1 s
  EXPECT_NE(text.find("about 6 s on 2 processors\n"), std::string::npos) << text;
  // Two files and two frames of 1 MB; of the files that are removed two for each processor: 2 + 2 + 2 * 2 * 3 MB.
  const std::string passing = estimate_text({{"raw", 2, 1, 3e6, 0, true}, {"filtered", 2, 1, 1e6, 2, false}}, 2);
  EXPECT_NE(passing.find("disk: at most 16.0 MB"), std::string::npos) << passing;
  EXPECT_NE(passing.find("4.0                  2.0 MB"), std::string::npos) << passing;
  EXPECT_NE(estimate_text({{"frame-render", 1000, 36, 0}}, 2).find("about 5.0 hours on 2"), std::string::npos);
}

}  // namespace
}  // namespace tempolux
