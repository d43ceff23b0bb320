#include "lib/render/data_channels.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "formats/error.h"
#include "lib/core/parallel_each.h"
#include "lib/image/channel_groups.h"
#include "lib/render/known_light.h"

namespace tempolux {

void add_influence_channels(const RenderScene& scene, const CameraView& view, const LocalisedLight* light,
                            const std::vector<std::string>& channels, Image& image) {
  if (!asked(channels, "influence")) return;
  if (!light)
    throw InputError(
        "--channels influence: only a cache of localised gathering knows it (irradcache-build records --update)");
  float* const influence = image.add("influence").values.data();
  float* const share = image.add("blend").values.data();
  parallel_pixels(view.width(), view.height(), [&](int x, int y, std::size_t p) {
    const std::optional<SeenPoint> seen = seen_through(scene.tracer, view, {float(x) + 0.5f, float(y) + 0.5f, {}});
    if (!seen) return;
    const float here = light->influence(seen->surface, seen->normal);
    influence[p] = std::isfinite(here) ? here : light->thresholds().high;
    share[p] = light->gathered_share(seen->surface, seen->normal);
  });
}

}  // namespace tempolux
