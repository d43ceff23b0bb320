// Which lobes a material has, with and without textures; the solids that a path is inside.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lib/material/inside.h"
#include "lib/material/smooth_material.h"
#include "lib/material/surface_material.h"

namespace tempolux {
namespace {

Material metal(float roughness) {
  Material material;
  material.roughness = roughness;
  return material;  // metallic is 1 by default
}

TEST(Lobes, ATextureOfMetalnessMayUncoverALambertLobe) {
  Material material = metal(0.5f);
  EXPECT_FALSE(lobes_of(material).lambert);
  EXPECT_FALSE(may_have_lambert(material));
  EXPECT_TRUE(lobes_of(material).specular);
  material.textures.emplace().metallic_roughness.image = 0;
  EXPECT_TRUE(may_have_lambert(material));
  EXPECT_TRUE(lobes_of(material).lambert);
}

TEST(SmoothMaterial, IsTheFirstMirrorThatASurfaceUses) {
  Primitive triangle;
  triangle.triangles = {{0, 1, 2}};
  SceneFrame frame;
  frame.materials = {metal(0.0f), metal(0.5f), metal(0.01f)};
  EXPECT_EQ(first_smooth_material(frame), kNone);
  for (const std::uint32_t material : {1u, 2u}) {
    Surface surface;
    surface.material = material;
    surface.primitive = &triangle;
    frame.surfaces.push_back(surface);
  }
  EXPECT_EQ(first_smooth_material(frame), 2u);
}

Material glass(float ior, float half_length) {
  Material material;
  material.transmission = 1;
  material.thin_walled = false;
  material.ior = ior;
  material.attenuation_color = Rgb(0.5f);
  material.attenuation_distance = half_length;
  return material;
}

// Half of the light remains after half_length m: a quarter after twice as far.
TEST(Inside, OnlyTheInnermostSolidAbsorbs) {
  const std::vector<Material> materials{glass(1.5f, 1), glass(2, 4)};
  Inside inside;
  EXPECT_EQ(inside.transmittance_over(materials, 2).r, 1);
  inside.scatter(0, true, true);  // into the first solid
  EXPECT_NEAR(inside.transmittance_over(materials, 2).r, 0.25f, 1e-6f);
  EXPECT_NEAR(inside.index_squared(materials), 2.25f, 1e-6f);
  inside.scatter(1, true, true);  // into the second, inside the first
  EXPECT_NEAR(inside.transmittance_over(materials, 4).r, 0.5f, 1e-6f);
  EXPECT_NEAR(inside.index_squared(materials), 9, 1e-5f);
  inside.scatter(0, false, true);  // out of the first: the second remains
  EXPECT_NEAR(inside.transmittance_over(materials, 4).r, 0.5f, 1e-6f);
  inside.scatter(1, false, false);  // reflected inside the second
  EXPECT_TRUE(inside.any());
  inside.scatter(1, false, true);
  EXPECT_FALSE(inside.any());
}

TEST(Inside, APathThatStartsInASolidShowsItAtTheFirstBack) {
  const std::vector<Material> materials{glass(1.5f, 1)};
  Inside inside;
  EXPECT_NEAR(inside.transmittance_to(materials, 0, false, 1).r, 0.5f, 1e-6f);
  EXPECT_EQ(inside.transmittance_to(materials, 0, true, 1).r, 1);
  EXPECT_NEAR(inside.index_squared_of_start(materials, 0, false), 2.25f, 1e-6f);
  EXPECT_EQ(inside.index_squared_of_start(materials, 0, true), 1);
  inside.scatter(0, false, false);
  EXPECT_TRUE(inside.any());
}

}  // namespace
}  // namespace tempolux
