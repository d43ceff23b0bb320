// Specular-glossiness as metallic-roughness: equations on paper, and textures texel by texel.
#include "lib/image/specular_glossiness.h"

#include <gtest/gtest.h>

#include "lib/image/srgb.h"

namespace tempolux {
namespace {

/// F0 and Lambert albedo of a metallic-roughness material of ior 1.5.
Rgb f0_of(const MetallicTexel& t) { return Rgb(0.04f) * (1 - t.metallic) + t.base_color * t.metallic; }
Rgb albedo_of(const MetallicTexel& t) { return t.base_color * (1 - t.metallic); }

void expect_near(Rgb a, Rgb b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << c;
}

TEST(SpecularGlossiness, DielectricsAndMetalsAreMetExactly) {
  const MetallicTexel plastic = metallic_of(Rgb{0.5f, 0.25f, 0.1f}, Rgb(0.04f));
  EXPECT_EQ(plastic.metallic, 0);
  expect_near(plastic.base_color, Rgb{0.5f, 0.25f, 0.1f}, 0);
  const MetallicTexel gold = metallic_of(Rgb(0.0f), Rgb{1.0f, 0.7f, 0.3f});
  EXPECT_EQ(gold.metallic, 1);
  expect_near(gold.base_color, Rgb{1.0f, 0.7f, 0.3f}, 1e-6f);
}

// Grey materials have one equation for each unknown, so both F0 and albedo are met.
TEST(SpecularGlossiness, GreyMaterialsAreMetExactly) {
  for (const float diffuse : {0.05f, 0.2f, 0.5f})
    for (const float specular : {0.05f, 0.2f, 0.45f}) {
      const MetallicTexel texel = metallic_of(Rgb(diffuse), Rgb(specular));
      expect_near(albedo_of(texel), Rgb(diffuse), 1e-5f);
      expect_near(f0_of(texel), Rgb(specular), 1e-5f);
    }
}

TEST(SpecularGlossiness, ReflectanceBelowGlassIsNoMetal) {
  EXPECT_EQ(metallic_of(Rgb(0.01f), Rgb(0.02f)).metallic, 0);
  EXPECT_EQ(metallic_of(Rgb(0.0f), Rgb(0.0f)).metallic, 0);
}

TEST(SpecularGlossiness, TexturesAreMadeTexelByTexel) {
  // Left: a dielectric of glossiness 1; right: red metal of glossiness 0. The diffuse image has one texel for both
  // rows.
  const CodedPixels diffuse{2, 1, 4, 8, {255, 255, 255, 128, 0, 0, 0, 255}};
  const std::uint8_t glass = std::uint8_t(std::lround(255 * linear_to_srgb(0.04f)));
  const CodedPixels specular{
      2, 2, 4, 8, {glass, glass, glass, 255, 255, 0, 0, 0, glass, glass, glass, 255, 255, 0, 0, 0}};
  SpecularGlossiness made;
  made.glossiness_factor = 0.5f;
  const CodedPixels base = made.make(diffuse, specular);
  ASSERT_EQ(base.width, 2);
  ASSERT_EQ(base.height, 2);
  ASSERT_EQ(base.channels, 4);
  EXPECT_NEAR(base.bytes[0], 255, 1);
  EXPECT_EQ(base.bytes[3], 128);
  EXPECT_NEAR(base.bytes[12], 255, 1);
  EXPECT_EQ(base.bytes[13], 0);
  made.makes = SpecularGlossiness::Makes::metallic_roughness;
  const CodedPixels share = made.make(diffuse, specular);
  ASSERT_EQ(share.channels, 3);
  EXPECT_EQ(share.bytes[1], 128);  // roughness 1 - .5 x 1
  EXPECT_LE(share.bytes[2], 1);
  EXPECT_EQ(share.bytes[4], 255);  // 1 - .5 x 0
  EXPECT_GE(share.bytes[5], 254);
}

}  // namespace
}  // namespace tempolux
