#include "lib/transport/specular_chain.h"

namespace tempolux {

bool SpecularChain::meet() {
  hit_ = {};
  if (!tracer_.intersect(ray_, hit_)) return false;
  point_ = tracer_.surface_point(hit_);
  point_.plate = 0;
  way_ += hit_.t;
  front_ = dot(point_.normal_geometric, ray_.direction) < 0;
  passed_ *= inside_.transmittance_to(tracer_.frame().materials, point_.material, front_, hit_.t);
  return true;
}

const ShadingPoint& SpecularChain::shade(float width) {
  material_.emplace(tracer_.frame(), point_, width);
  return shading_.emplace(point_, -ray_.direction, *material_);
}

void SpecularChain::go_on(const Scattered& event) {
  event.pass(point_, material(), front_, inside_);
  passed_ *= event.sample.weight;
  ray_ = spawn_ray(point_, event.travel);
  ++events_;
}

}  // namespace tempolux
