#include "tools/stages/frame_audit.h"

#include <algorithm>

#include "lib/audit/photon_splats.h"
#include "lib/core/formatted.h"
#include "lib/core/random.h"
#include "lib/material/smooth_material.h"
#include "lib/pilot/hidden_light.h"
#include "lib/pilot/seen_spheres.h"
#include "lib/render/data_channels.h"

namespace tempolux::tools {

Lights AuditedFrame::aimed(Lights::Which which) const { return aimed_lights(scene.tracer, emission, view, which); }

double AuditedFrame::hidden_light() const {
  if (!hidden)
    hidden = hidden_share(scene, aimed(Lights::Which::punctual), view, mean_to_white(rendered.mean.pixels, {}));
  return *hidden;
}
void warn_of_missing_light(Tool& tool, const AuditedFrame& made) {
  const SceneFrame& frame = made.scene.frame();
  const KnownLight* const known = made.options.known;
  if (!may_hide_light(frame) || (known && known->has_caustic()) || made.light_paths > 0) return;
  const auto shines =
      std::ranges::find_if(frame.lights, [](const PlacedLight& l) { return max_component(l.light.intensity) > 0; });
  std::string share;
  if (known) {
    if (!(made.hidden_light() > 0)) return;
    share = formatted(" (%.2g %% of the picture)", 100 * made.hidden_light());
  }
  const std::string &material = frame.materials[first_smooth_material(frame)].name, &light = shines->light.name;
  tool.warn(frame.scene->path + ": materials" + (material.empty() ? "" : " \"" + material + "\"") +
            ": what point, spot and sun lights send by way of mirrors and smooth glass is missing" + share +
            (light.empty() ? "" : ", as that of light \"" + light + "\"") +
            ": no path finds it; photons do (--photons; make: INDIRECT=gather or records)");
}

std::vector<AuditEntry> audit(Tool& tool, const RenderOptions& options, const AuditedFrame& made, bool& unbiased) {
  if (!(options.audit > 0)) return {};
  const RenderScene& scene = made.scene;
  const CameraView& view = made.view;
  const EnvironmentLight* const environment = made.emission.environment.get();
  const auto is_plate = [&](std::uint32_t surface) { return scene.tracer.is_plate(surface); };
  const bool suns = scene.lights.has_suns() || (environment && environment->has_sun()),
             hidden = suns && (first_smooth_material(scene.frame(), false, is_plate) != kNone ||
                               (may_hide_light(scene.frame()) && made.hidden_light() > 0)),
             paths = scene.lights.has_distant() && !hidden, photons = hidden || scene.lights.has_placed(),
             specular = photons && !options.traces_paths() && !scene.frame().media;
  unbiased = paths && !photons && options.traces_paths();
  if (unbiased) return {};
  tool.stats().phase("audit", true);
  Image ids{view.width(), view.height(), {}, {}, {}, {}};
  add_data_channels(scene, view, {"id"}, {}, {}, ids);
  const Tracer& tracer = scene.tracer;
  AuditEffort effort = audit_effort(options.audit, made.rendered.rays, photons, paths, specular,
                                    mix64(made.options.seed + std::uint64_t(tracer.frame().frame)));
  const auto measure = [&] {
    FrameAudit audit(view, made.rendered, ids.channels.front().ids, made.options.mask, scene.camera_inside);
    std::optional<SpecularHits> hits;
    if (specular && photons) hits.emplace(scene, view, made.options.mask, effort.specular_paths, ~effort.seed);
    if (photons)
      audit.add_photons(tracer, made.aimed(hidden ? Lights::Which::all : Lights::Which::placed), effort,
                        hits ? &*hits : nullptr);
    if (paths) {
      const Lights distant(tracer.frame(), made.emission, Lights::Which::distant);
      audit.add_paths({tracer, distant, distant.has_suns(), scene.camera_inside}, effort);
    }
    return audit.entries();
  };
  const std::vector<AuditEntry> entries = measure();
  const auto warns = [](const AuditEntry& entry) {
    return entry.part == "picture" && entry.layer != Layer::direct && is_biased(entry);
  };
  if (std::ranges::none_of(entries, warns)) return entries;
  // In one of a hundred unbiased frames chance alone gives such a figure. A larger audit with another seed decides.
  effort.photon_paths *= kAuditAgain, effort.eye_paths *= kAuditAgain, effort.specular_paths *= kAuditAgain;
  effort.seed = mix64(effort.seed);
  return measure();
}

void add_light_without_paths(Tool& tool, const RenderOptions& options, const AuditedFrame& made,
                             RenderedFrame& rendered) {
  const bool of_all_lamps = made.scene.without_hidden_light;
  if (options.light_paths == 0 || (!of_all_lamps && !may_hide_light(made.scene.frame()))) return;
  tool.stats().phase("light paths", true);
  if (may_hide_light(made.scene.frame()))
    tool.say("light paths: what mirrors, glass and gloss show of their light is still missing (layer specular)");
  const Lights lights = made.aimed(of_all_lamps ? Lights::Which::lamps : Lights::Which::punctual);
  const auto add = [&](std::uint64_t paths, std::uint64_t number, LayerImage& picture) {
    const std::uint64_t seed = mix64(made.options.seed ^ (0x6c69676874ull << 8 | number));
    add_hidden_light(made.scene, lights, made.view, paths, seed, picture);
  };
  if (rendered.half[0].pixels.empty()) return add(options.light_paths, 0, rendered.mean);
  for (const std::size_t h : {0u, 1u}) {
    const std::vector<Layers> before = rendered.half[h].pixels;
    add(options.light_paths / 2, h, rendered.half[h]);
    for (std::size_t p = 0; p < before.size(); ++p)
      for (std::size_t l = 0; l < kLayerCount; ++l)
        rendered.mean.pixels[p].value[l] += (rendered.half[h].pixels[p].value[l] - before[p].value[l]) * 0.5f;
  }
}

}  // namespace tempolux::tools
