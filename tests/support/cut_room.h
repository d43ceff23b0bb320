// tests/support/cut_room.h -- a closed room with a sheet across it that keeps all light in the room.
#pragma once

#include <array>
#include <cmath>

#include "lib/core/sobol.h"
#include "lib/render/known_light.h"
#include "lib/render/path_tracer.h"
#include "tests/support/chain.h"
#include "tests/support/mean.h"

namespace tempolux::test {

/// A room 4 m long with walls of reflectance one half, cut in the middle by a sheet of the given material. If the sheet
/// absorbs nothing, the walls receive the irradiance kIrradiance in the mean.
struct CutRoom {
  static constexpr double kArea = 2 * 4 + 4 * 8, kRho = 0.5, kFlux = M_PI * 4;  ///< of the walls: m^2, 1, W
  static constexpr double kIrradiance = kFlux / (kArea * (1 - kRho));           ///< W/m^2
  HandMadeScene scene;

  /// everywhere: radiance that all walls emit [W/m^2/sr]; 0: one end wall emits 1.
  explicit CutRoom(Material sheet, float everywhere = 0) {
    const Vec3 l{-2, -1, -1}, u{2, 1, 1};
    const auto wall = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d, float emission) {
      scene.add_quad(a, b, c, d, matte(Rgb(float(kRho)), Rgb(emission)));
    };
    wall({l.x, l.y, l.z}, {l.x, u.y, l.z}, {l.x, u.y, u.z}, {l.x, l.y, u.z}, everywhere > 0 ? everywhere : 1);
    wall({u.x, l.y, l.z}, {u.x, l.y, u.z}, {u.x, u.y, u.z}, {u.x, u.y, l.z}, everywhere);
    wall({l.x, l.y, l.z}, {l.x, l.y, u.z}, {u.x, l.y, u.z}, {u.x, l.y, l.z}, everywhere);
    wall({l.x, u.y, l.z}, {u.x, u.y, l.z}, {u.x, u.y, u.z}, {l.x, u.y, u.z}, everywhere);
    wall({l.x, l.y, l.z}, {u.x, l.y, l.z}, {u.x, u.y, l.z}, {l.x, u.y, l.z}, everywhere);
    wall({l.x, l.y, u.z}, {l.x, u.y, u.z}, {u.x, u.y, u.z}, {u.x, l.y, u.z}, everywhere);
    sheet.double_sided = true;
    scene.add_quad({0, l.y, l.z}, {0, u.y, l.z}, {0, u.y, u.z}, {0, l.y, u.z}, sheet);
  }

  /// Calls each(i, p, n) for `count` places p of the walls, uniform in their area, with their normals n.
  template <class Each>
  static void for_each_place(const Chain& chain, std::uint32_t count, const Each& each) {
    const AreaSampler area(chain.frame);
    const double share = kArea / area.area();  // the sheet is sampled last
    for (std::uint32_t i = 0; i < count; ++i) {
      Vec3 p, n;
      area.sample((float(i) + 0.5f) / float(count) * float(share), sobol_owen_2d(i, 5), p, n);
      each(i, p, n);
    }
  }

  /// Layers of camera paths that start just above the walls, as means over all walls.
  static std::array<double, kLayerCount> on_walls(const Chain& chain, const KnownLight* known, std::uint32_t count) {
    std::array<double, kLayerCount> mean{};
    RayCounts counts;
    for_each_place(chain, count, [&](std::uint32_t i, Vec3 p, Vec3 n) {
      const Layers seen = trace_eye_path({chain.tracer, chain.lights}, {p + n * 0.01f, -n, 0, INFINITY},
                                         PixelRandom(3, i, 0), known, counts);
      for (std::size_t l = 0; l < kLayerCount; ++l) mean[l] += double(seen.value[l].g) / count;
    });
    return mean;
  }

  /// Mean irradiance of the walls [W/m^2] by gather rays, which leave out direct light.
  static double gathered(const Chain& chain, const FinalGather& gather) {
    GatherCounts counts;
    Mean mean;
    for_each_place(chain, 2000, [&](std::uint32_t, Vec3 p, Vec3 n) {
      if (const auto place = chain.surface_at(p, n, 0.01f))
        mean.add(double(gather.gather(place->first, n, counts).irradiance.g));
    });
    return mean.mean();
  }
};

}  // namespace tempolux::test
