#include "lib/render/influence_channels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/render/known_light.h"

namespace tempolux {

void add_influence_channels(const RenderScene& scene, const CameraView& view, const LocalisedLight* light,
                            const std::vector<std::string>& channels, Image& image) {
  if (std::find(channels.begin(), channels.end(), "influence") == channels.end()) return;
  if (!light) throw InputError("--channels influence: only a cache of localised gathering knows it (irradcache-build records --update)");
  image.add("influence");
  std::vector<float>& share = image.add("blend").values;
  std::vector<float>& influence = image.find("influence")->values;
  const auto width = std::size_t(view.width());
  parallel_chunks(share.size(), 64 * kLooksTogether, [&](std::size_t first, std::size_t last) {
    std::array<Look, kLooksTogether> looks;
    std::array<std::optional<SeenPoint>, kLooksTogether> seen;
    for (std::size_t p = first; p < last; p += kLooksTogether) {
      const std::size_t count = std::min(kLooksTogether, last - p);
      for (std::size_t i = 0; i < count; ++i) looks[i] = {float((p + i) % width) + 0.5f, float((p + i) / width) + 0.5f, std::nullopt};
      seen_through(scene.tracer, view, std::span(looks).first(count), std::span(seen).first(count));
      for (std::size_t i = 0; i < count; ++i) {
        if (!seen[i]) continue;
        const float here = light->influence(seen[i]->surface, seen[i]->normal);
        influence[p + i] = std::isfinite(here) ? here : light->thresholds().high;
        share[p + i] = light->gathered_share(seen[i]->surface, seen[i]->normal);
      }
    }
  });
}

}  // namespace tempolux
