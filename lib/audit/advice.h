// lib/audit/advice.h -- what mends the bias or the noise of a layer of a frame. All is inline, so that tempolux-info
// need not link the renderer.
#pragma once

#include <string>

#include "lib/render/path_tracer.h"

namespace tempolux {

/// For whom an advice is written: options of the tools, or variables of make.
enum class AdviceFor { tools, make };

/// What a frame's indirect light comes from: photons, points and records, or a light texture.
enum class LitBy { points, texture };

/// Advice to users on how to reduce the bias of a layer, such as "more points (POINTS=...) mend it". Irradiance points,
/// records, light textures and photons cause bias. Layers that frames sample without bias get "".
inline std::string advice_on_bias(Layer layer, AdviceFor reader, LitBy lit = LitBy::points) {
  const bool make = reader == AdviceFor::make;
  if (lit == LitBy::texture && (layer == Layer::indirect || layer == Layer::specular))
    return make ? "METHOD=frames mends it" : "points and records in place of --meshirrad mend it";
  const std::string photons = make ? "more photons (PHOTONS)" : "more photons (photon-trace --photons)";
  const std::string points =
      make ? "more points (POINTS=\"--point-count N\")"
           : "more points (irradcache-build --point-count), bright ones apart (photonmap-split, --high)";
  const std::string paths = make ? "INDIRECT=paths" : "paths (no files of light)";
  switch (layer) {
    case Layer::caustic: return photons + " mend it";
    case Layer::indirect: return points + ", " + photons + " or " + paths + " mend it";
    case Layer::specular:
      return points + ", from which mirrors and glass show indirect light, or " + paths + " mend it";
    case Layer::volume: return photons + " mend it";
    case Layer::emission:
    case Layer::direct: return "";
  }
  return "";
}

/// What lowers noise of samples that stays at the limit of samples per pixel. `layer` has the most noise.
inline std::string advice_on_samples(Layer layer) {
  switch (layer) {
    case Layer::caustic: return "give photons (--photons), which find caustics";
    case Layer::indirect: return "give files of light (--points, --irradcache)";
    case Layer::specular: return "raise the limit, or make mirrors and glass a little rough";
    case Layer::emission:
    case Layer::direct:
    case Layer::volume: return "raise the limit";
  }
  return "";
}

}  // namespace tempolux
