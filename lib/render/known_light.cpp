#include "lib/render/known_light.h"

#include "lib/render/localised_light.h"
#include "lib/transport/specular_chain.h"

namespace tempolux {

std::optional<Rgb> KnownLight::indirect(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, Rgb* noise) const {
  switch (indirect_by()) {
    case IndirectBy::texture: return mesh->irradiance(surface, geometric);
    case IndirectBy::localised: return localised->at(surface, shading, noise);
    case IndirectBy::photons: return photons->indirect(surface.position, geometric);
    case IndirectBy::records: {
      const RecordStore::Interpolated found = records->interpolate(surface.position, shading);
      if (noise) *noise = found.noise;
      return found.weight > 0 ? std::optional(found.irradiance) : std::nullopt;
    }
    default: return std::nullopt;
  }
}

std::optional<KnownLight::PointLight> KnownLight::point_light(const SurfacePoint& hit, Vec3 geometric, float distance,
                                                              float u) const {
  if (!points) return std::nullopt;
  const PointLookup::Light* light = points->find(hit.position, geometric);
  if (!light || !points->is_uniform_indirect(*light) || PointLookup::is_near(*light, distance, u)) return std::nullopt;
  if (points->is_uniform(*light)) return PointLight{light->all};
  const IrradiancePoint& point = points->point(*light);
  return PointLight{point.indirect + point.caustic, false};
}

float KnownLight::remaining_share(const SurfacePoint& hit, Vec3 geometric, float distance, float u) const {
  const PointLookup::Light* light = bright ? points->find(hit.position, geometric) : nullptr;
  return light && !PointLookup::is_near(*light, distance, u) ? bright->remaining_share(*light, distance) : 1.0f;
}

namespace {

/// A surface that transmits diffusely needs light on both sides: the point is seen from one of them. look.random draws
/// the side; without it the side with more light is taken.
SeenPoint seen_from_a_side(SpecularChain& chain, const ShadingPoint& shading, float step, const Look& look) {
  const SideChoice side = choose_side(shading.bsdf, shading.wo_local, chain.material(),
                                      look.random ? look.random->get1(chain.events(), Purpose::side) : 0.5f);
  const Vec3 normal = side.far_side ? SeenSide(chain.point(), chain.ray().direction).normal : shading.normal;
  return {chain.point(), normal, step, true, chain.passed() / side.chance, chain.events() > 0, side.far_side};
}

}  // namespace

std::optional<SeenPoint> seen_through(const Tracer& tracer, const CameraView& view, const Look& look) {
  SpecularChain chain(tracer, view.pinhole({look.x, look.y}));
  while (chain.meet()) {
    // Size of a pixel at the hit: the angle between the rays of neighbouring pixels times the length of the path.
    const float step = view.pixel_size(chain.way());
    const ShadingPoint& shading = chain.shade(step);
    if (shading.bsdf.has_diffuse()) {
      if (transmits_diffusely(chain.material())) [[unlikely]]
        return seen_from_a_side(chain, shading, step, look);
      const bool mirrored = chain.events() > 0;
      return SeenPoint{chain.point(), shading.normal, step, mirrored, chain.passed(), mirrored};
    }
    const std::uint32_t mirrors = chain.events();
    if (mirrors + 1 == kMostMirrors) break;
    // u = 0.5 chooses the lobe that has more than half of the light.
    const Scattered next(shading, look.random ? look.random->get1(mirrors, Purpose::lobe) : 0.5f,
                         look.random ? look.random->get2(mirrors, Purpose::scatter) : Vec2{0.5f, 0.5f});
    if (is_black(next.sample.weight)) break;
    chain.go_on(next);
  }
  return std::nullopt;
}

}  // namespace tempolux
