#include "lib/render/matte_channels.h"

#include "lib/core/parallel_each.h"
#include "lib/image/channel_groups.h"
#include "lib/image/cryptomatte.h"
#include "lib/render/shutter.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kSamplesOfKept = 16;  ///< of pixels that another frame gives; as many as coverage has rays

void count_one(std::uint32_t number, std::vector<MatteCount>& counts) {
  for (MatteCount& count : counts)
    if (count.number == number) {
      ++count.samples;
      return;
    }
  counts.push_back({number, 1});
}

/// What the camera samples of one pixel see.
struct SeenMattes {
  std::vector<MatteCount> objects, materials;

  void look(const SeenNow& now, const CameraSample& sample) {
    Hit hit;
    if (!now.scene.tracer.intersect(now.view.ray(sample), hit)) return;
    const Surface& surface = now.scene.frame().surfaces[hit.surface];
    count_one(surface.object, objects);
    count_one(surface.material, materials);
  }
};

std::vector<std::string> material_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  if (!names.empty() && names.back().empty()) names.back() = "default material";  // of primitives without one
  return names;
}

}  // namespace

MatteNames::MatteNames(const Scene& scene)
    : objects(matte_names(scene.object_names, "object")), materials(matte_names(material_names(scene), "material")) {}

void add_matte_channels(const RenderScene& scene, const CameraView& view, const FrameOptions& options,
                        const RenderedFrame& rendered, const MatteNames& names,
                        const std::vector<std::string>& channels, Image& image) {
  if (!asked(channels, "cryptomatte")) return;
  MatteChannels objects(kObjectMattes, names.objects, image), materials(kMaterialMattes, names.materials, image);
  const std::vector<std::uint64_t> seeds = seeds_of_samples(options);
  const auto samples_at = [&](std::size_t p) {
    if (!options.mask.empty() && !options.mask[p]) return kSamplesOfKept;
    if (!rendered.camera_samples.empty()) return rendered.camera_samples[p];
    return std::uint32_t(rendered.mean.samples) / std::uint32_t(seeds.size());
  };
  parallel_pixels(view.width(), view.height(), [&](int x, int y, std::size_t p) {
    SeenMattes seen;
    const std::uint32_t samples = samples_at(p);
    for (const std::uint64_t seed : seeds)
      for (std::uint32_t i = 0; i < samples; ++i) {
        const PixelRandom random(seed, p, i);
        const SeenNow now = seen_now({scene, view}, options.shutter, random);
        seen.look(now, sample_of_pixel(now.view, x, y, random));
      }
    const std::uint32_t total = samples * std::uint32_t(seeds.size());
    objects.set(p, seen.objects, total);
    materials.set(p, seen.materials, total);
  });
  objects.describe(image);
  materials.describe(image);
}

}  // namespace tempolux
