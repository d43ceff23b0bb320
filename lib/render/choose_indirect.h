// lib/render/choose_indirect.h -- by which way indirect light is cheapest in a scene, told by a pilot of a few thousand paths.
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// How the light that surfaces send each other is found: by records between pixels, by one ray of the hemisphere for each sample of a
/// pixel, which ends at irradiance points, or by paths that end nowhere but in the dark.
enum class IndirectMethod : std::uint8_t { records, gather, paths };
inline constexpr const char* kIndirectMethods[] = {"records", "gather", "paths"};

/// What a pilot saw of the surfaces that a camera sees.
struct IndirectPilot {
  double scattered = 0;        ///< mean radiance of the light that they scatter
  double indirect_share = 0;   ///< of that: layer indirect over direct, caustic and indirect
  double open_share = 0;       ///< of the rays of their hemispheres: leave the scene
  double lamp_share = 0;       ///< of the light that comes straight from lights: not from the sky or a sun
  int places = 0;              ///< seen; 0: nothing is
  /// Means over the picture, of the square of radiance (mean of channels): the variance of a path's indirect light, and the squared error
  /// that all other light has left when frame-render has spent the samples that `pixel_error` asks for.
  double indirect_variance = 0, other_error2 = 0;
  /// The same of samples that were independent: of all but layer indirect, and of paths alone all but layer caustic; samples a pixel.
  double other_noise = 0, rest_noise = 0, samples = 0;
  double caustic = 0, caustic_variance = 0;   ///< of layer caustic by paths: its mean radiance, the variance of one path
  int paths = 0;               ///< of which these are means
};

/// 2048 places and 8192 paths: some hundredths of a second. Same result for any number of threads.
IndirectPilot pilot_indirect(const RenderScene& scene, const CameraView& view, double pixel_error, std::uint64_t seed);

/// Gather rays of a record, `most` at most, that leave its light about a tenth of the squared error that the pixels have otherwise: then the
/// picture is within 5 % of the error that any number of rays would give. At least a tenth of `most`: records of few rays place badly.
/// docs/pixels.md has the measurements.
int record_rays(const IndirectPilot& pilot, int most);

inline constexpr double kLittleIndirect = 0.05;   ///< share of what surfaces scatter below which paths do
inline constexpr double kOpenScene = 0.35;        ///< of the rays from what is seen, that leave the scene: between rooms (0 to .15) and the open air (.4 and more)
/// Noise of paths' indirect light over that of all other light above which gathering pays: photons, points and looking them up cost 3 to 5 times as much.
inline constexpr double kIndirectPays = 5;

struct IndirectChoice {
  IndirectMethod method;
  std::string because;
};

/// Paths where indirect light is little or most rays leave the scene: what photons, points and records cost is then more than
/// they save. But not under lamps if the noise of paths is mostly that of indirect light, as bounces that land beside a point lamp make it: gathering. Else records:
/// light comes from a few bright patches, lamps or what sun and sky light through openings, which rays of single pixels seldom find. docs/pixels.md has the measurements that the limits are from.
IndirectChoice choose_indirect(const IndirectPilot& pilot);

}  // namespace tempolux
