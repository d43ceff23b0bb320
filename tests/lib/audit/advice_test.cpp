// What a warning advises follows from the layer that has the bias or the noise.
#include "lib/audit/advice.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

struct Case {
  Layer layer;
  const char *bias_says, *bias_says_not, *samples_say;
};
// Seen to fail: caustic light, which only photons bring, was advised points; light of lamps at the limit of samples was
// advised files of indirect light.
constexpr Case kCases[] = {{Layer::caustic, "PHOTONS", "POINTS", "--photons"},
                           {Layer::indirect, "POINTS", "rough", "--irradcache"},
                           {Layer::specular, "POINTS", "PHOTONS", "rough"},
                           {Layer::volume, "PHOTONS", "POINTS", "limit"}};

TEST(Advice, FollowsFromTheLayer) {
  for (const Case& c : kCases) {
    const std::string bias = advice_on_bias(c.layer, AdviceFor::make);
    EXPECT_NE(bias.find(c.bias_says), std::string::npos) << bias;
    EXPECT_EQ(bias.find(c.bias_says_not), std::string::npos) << bias;
    EXPECT_NE(advice_on_samples(c.layer).find(c.samples_say), std::string::npos) << advice_on_samples(c.layer);
  }
  for (const Layer sampled : {Layer::emission, Layer::direct}) {
    EXPECT_EQ(advice_on_bias(sampled, AdviceFor::make), "");
    EXPECT_EQ(advice_on_samples(sampled), "raise the limit");
  }
}

/// A preview has neither points nor records. Seen to fail: it was advised more points.
TEST(Advice, PreviewsAreAdvisedAnotherMethod) {
  for (const Layer layer : {Layer::indirect, Layer::specular})
    EXPECT_EQ(advice_on_bias(layer, AdviceFor::make, LitBy::texture), "METHOD=frames mends it");
  EXPECT_EQ(advice_on_bias(Layer::caustic, AdviceFor::make, LitBy::texture),
            advice_on_bias(Layer::caustic, AdviceFor::make));
}

TEST(Advice, NamesOptionsToThoseWhoRunTools) {
  EXPECT_NE(advice_on_bias(Layer::indirect, AdviceFor::tools).find("--point-count"), std::string::npos);
  EXPECT_EQ(advice_on_bias(Layer::indirect, AdviceFor::tools).find("POINTS"), std::string::npos);
}

}  // namespace
}  // namespace tempolux
