#include "lib/material/dispersion.h"

namespace tempolux {

HeroWavelength hero_wavelength(float u) {
  using namespace spectrum_table;
  const float position = std::clamp(u, 0.0f, 1.0f) * kSteps;
  const int step = std::min(int(position), kSteps - 1);
  const float part = position - float(step);
  const auto between = [&](float a, float b) { return a + (b - a) * part; };
  HeroWavelength hero{between(kWavelength[step], kWavelength[step + 1])};
  for (int c = 0; c < 3; ++c) hero.color[c] = between(kColor[step][c], kColor[step + 1][c]);
  return hero;
}

}  // namespace tempolux
