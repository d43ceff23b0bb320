// tests/support/closed_box.h -- closed rooms with a point light, whose light is known on paper.
//
// All surfaces have the reflectance rho. A lamp of flux F is inside, and S is the area of all surfaces. Every
// reflection keeps the share rho of the flux. So the surfaces receive F (1 + rho + rho^2 + ...) = F / (1 - rho) in
// all, and F / (S (1 - rho)) per area on average. The part after at least one reflection is F rho / (S (1 - rho)) per
// area.
#pragma once

#include "lib/light/lights.h"
#include "tests/support/scenes.h"

namespace tempolux::test {

enum class Shape { cube, corridor, sphere };
inline const char* name_of(Shape shape) {
  return shape == Shape::cube ? "cube" : shape == Shape::corridor ? "corridor" : "sphere";
}

struct ClosedBox {
  HandMadeScene scene;
  Rgb flux;  ///< F, W
  EmissionTable table;

  ClosedBox(Shape shape, float rho, Rgb intensity = Rgb(1.0f, 2.0f, 0.5f)) : flux(intensity * (4 * kPi)) {
    const Material material = matte(Rgb(rho));
    if (shape == Shape::cube) scene.add_room({-1, -1, -1}, {1, 1, 1}, material);
    if (shape == Shape::corridor) scene.add_room({-5, -0.5f, -0.5f}, {5, 0.5f, 0.5f}, material);
    if (shape == Shape::sphere) scene.add_hollow_sphere({}, 1, 12, material);
    scene.add_point_light({0.13f, 0.21f, -0.17f}, intensity);
    table = build_emission_table({&scene.frame(), 1});
  }
};

}  // namespace tempolux::test
