#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/material/bsdf.h"
#include "lib/render/frame_renderer.h"

namespace tempolux {
namespace {

const std::vector<std::string> kGroups{"RGBA",     "layers", "emission", "specular",  "direct",   "caustic",
                                       "indirect", "volume", "Z",        "N",         "P",        "id",
                                       "albedo",   "motion", "coverage", "influence", "variance", "diffuse.variance",
                                       "samples",  "halves", "seen"};

bool asked(const std::vector<std::string>& channels, const char* name) {
  return std::find(channels.begin(), channels.end(), name) != channels.end();
}

/// Finds the same point of the same surface in another frame, where movers have moved or deformed it. The same surface
/// has the same node and the same rank among that node's surfaces; the same point has the same barycentric coordinates.
class OtherFrame {
 public:
  OtherFrame(const NeighbourFrame& other, const SceneFrame& here) : view_(other.view), there_(here.surfaces.size()) {
    if (!other.frame) return;
    std::map<std::uint32_t, std::vector<const Surface*>> by_node;
    for (const Surface& surface : other.frame->surfaces) by_node[surface.node].push_back(&surface);
    std::map<std::uint32_t, std::size_t> rank;
    for (std::size_t s = 0; s < here.surfaces.size(); ++s) {
      const auto& candidates = by_node[here.surfaces[s].node];
      const std::size_t r = rank[here.surfaces[s].node]++;
      if (r < candidates.size() &&
          candidates[r]->primitive->triangles.size() == here.surfaces[s].primitive->triangles.size())
        there_[s] = candidates[r];
    }
  }
  /// Motion in pixels, right and up, from raster position `here` to the point's position in the other frame. Zero if
  /// the point is not in front of that frame's camera.
  Vec2 motion(const SurfacePoint& point, std::array<double, 2> here) const {
    const Surface* surface = there_[point.surface];
    if (!surface) return {};
    const auto& corner = surface->primitive->triangles[point.triangle];
    const auto raster = view_->project(surface->position(corner[0]) * (1 - point.u - point.v) +
                                       surface->position(corner[1]) * point.u + surface->position(corner[2]) * point.v);
    if (!raster) return {};
    return {float((*raster)[0] - here[0]), float(here[1] - (*raster)[1])};
  }

 private:
  const CameraView* view_;
  /// The other frame's surface by surface of this frame; nullptr: it does not exist there.
  std::vector<const Surface*> there_;
};

}  // namespace

void check_channels(const std::vector<std::string>& channels) {
  for (const std::string& name : channels)
    if (std::find(kGroups.begin(), kGroups.end(), name) == kGroups.end()) {
      std::string list;
      for (const std::string& group : kGroups) list += (list.empty() ? "" : ",") + group;
      throw InputError("--channels: '" + name + "' is no channel group; choose from " + list);
    }
}

void add_data_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       const NeighbourFrame& next, const NeighbourFrame& previous, Image& image) {
  // Channels are added first, then looked up: adding may move them.
  const auto add3 = [&](const char* a, const char* b, const char* c) {
    image.add(a);
    image.add(b);
    image.add(c);
  };
  const bool z = asked(channels, "Z"), n = asked(channels, "N"), p = asked(channels, "P"), id = asked(channels, "id"),
             albedo = asked(channels, "albedo"), motion = asked(channels, "motion");
  if (!(z || n || p || id || albedo || motion)) return;
  if (z) image.add("Z");
  if (n) add3("N.X", "N.Y", "N.Z");
  if (p) add3("P.X", "P.Y", "P.Z");
  if (albedo) add3("albedo.R", "albedo.G", "albedo.B");
  if (motion) {
    image.add("forward.u");
    image.add("forward.v");
    image.add("backward.u");
    image.add("backward.v");
  }
  if (id) image.add_ids("id.object");
  const auto values = [&](const char* name) -> float* {
    Channel* channel = image.find(name);
    return channel ? channel->values.data() : nullptr;
  };
  float *const Z = values("Z"), *const NX = values("N.X"), *const NY = values("N.Y"), *const NZ = values("N.Z"),
               *const PX = values("P.X"), *const PY = values("P.Y"), *const PZ = values("P.Z"),
               *const AR = values("albedo.R"), *const AG = values("albedo.G"), *const AB = values("albedo.B"),
               *const FU = values("forward.u"), *const FV = values("forward.v"), *const BU = values("backward.u"),
               *const BV = values("backward.v");
  std::uint32_t* const ID = id ? image.find("id.object")->ids.data() : nullptr;
  const OtherFrame later(motion ? next : NeighbourFrame{}, scene.frame());
  const OtherFrame earlier(motion ? previous : NeighbourFrame{}, scene.frame());
  const Vec3d origin = scene.frame().origin;
  const RayCone cone = view.cone();

  parallel_chunks(image.pixel_count(), 4096, [&](std::size_t first, std::size_t last) {
    constexpr std::size_t kTogether = 8;  // a packet
    std::array<Ray, kTogether> rays;
    std::array<Hit, kTogether> hits;
    const auto centre = [&](std::size_t i) {
      return Vec2{float(int(i % std::size_t(view.width()))) + 0.5f, float(int(i / std::size_t(view.width()))) + 0.5f};
    };
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t k = (i - first) % kTogether;
      if (k == 0) {
        const std::size_t count = std::min(kTogether, last - i);
        for (std::size_t j = 0; j < count; ++j) rays[j] = view.ray(centre(i + j).x, centre(i + j).y);
        scene.tracer.intersect(std::span(rays).first(count), std::span(hits).first(count));
      }
      const auto [x, y] = centre(i);
      const Ray& ray = rays[k];
      const Hit& hit = hits[k];
      if (hit.surface == kNone) {
        if (Z) Z[i] = INFINITY;
        if (ID) ID[i] = kNone;
        continue;
      }
      SurfacePoint point = scene.tracer.surface_point(hit);
      const SurfaceMaterial material(scene.frame(), point, cone.width + cone.spread * hit.t);
      if (Z) Z[i] = float(view.depth(point.position));
      if (ID) ID[i] = point.object;
      if (NX) {
        const Vec3 normal = dot(point.normal, ray.direction) > 0 ? -point.normal : point.normal;
        NX[i] = normal.x;
        NY[i] = normal.y;
        NZ[i] = normal.z;
      }
      if (PX) {
        const Vec3d world = Vec3d(point.position) + origin;
        PX[i] = float(world.x);
        PY[i] = float(world.y);
        PZ[i] = float(world.z);
      }
      if (AR) {
        const Bsdf bsdf(material);
        const Rgb rho = bsdf.diffuse_albedo();
        AR[i] = rho.r;
        AG[i] = rho.g;
        AB[i] = rho.b;
      }
      if (FU) {
        const std::array<double, 2> here = view.project(point.position).value_or(std::array{double(x), double(y)});
        const Vec2 f = later.motion(point, here), b = earlier.motion(point, here);
        FU[i] = f.x;
        FV[i] = f.y;
        BU[i] = b.x;
        BV[i] = b.y;
      }
    }
  });
}

}  // namespace tempolux
