#include "lib/gather/high_shares.h"

#include <algorithm>
#include <array>

namespace tempolux {

std::vector<float> shares_of_photons(const Tracer& tracer, const Lights& lights, const formats::PhotonMap& high,
                                     PointOptions options, std::span<const IrradiancePoint> whole) {
  std::vector<float> shares(whole.size(), 0.0f);
  if (high.photons.empty()) return shares;
  std::vector<IrradiancePoint> part(whole.begin(), whole.end());
  options.light_samples = 1;  // neither part holds direct light, and this estimate of it is not read
  const std::array<double, 3>& origin = high.header.origin;
  estimate_points(tracer, lights, high, Vec3d{origin[0], origin[1], origin[2]} - tracer.frame().origin, options, part);
  const auto sum = [](const Rgb& value) { return value[0] + value[1] + value[2]; };
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const float all = sum(whole[i].direct) + sum(whole[i].caustic) + sum(whole[i].indirect);
    const float bright = sum(part[i].caustic) + sum(part[i].indirect);
    if (all > 0) shares[i] = std::clamp(bright / all, 0.0f, 1.0f);
  }
  return shares;
}

}  // namespace tempolux
