// lib/warp/scene_view.h -- the surfaces that a camera sees at a frame, at pixel centres and between them.
#pragma once

#include <span>
#include <vector>

#include "lib/render/camera_view.h"
#include "lib/trace/trace.h"
#include "lib/warp/seen_surfaces.h"

namespace tempolux {

/// The first surface on each camera ray, without media.
class SceneView {
 public:
  /// Traces a ray through the centre of each pixel. Both references must outlive this object.
  SceneView(const Tracer& tracer, const CameraView& view);

  const FrameCamera& camera() const { return camera_; }
  const SeenSurfaces& seen() const { return seen_; }
  /// The hits by pixel.
  const std::vector<Hit>& hits() const { return hits_; }
  const SceneFrame& frame() const { return tracer_.frame(); }

  /// Traces rays through any raster positions: points[i] becomes the surface at at[i].
  void look(std::span<const RasterPoint> at, FacePoint* points) const;

  /// One entry per pixel; 1: the material has a specular or transmitting lobe.
  std::vector<std::uint8_t> gloss() const;

  /// Adds the groups (Z, N, id) that are named, with the bits of frame-render's data channels.
  void add_channels(const std::vector<std::string>& groups, Image& image) const;

 private:
  FacePoint point_of(const Hit& hit, const Ray& ray) const;

  const Tracer& tracer_;
  const CameraView& view_;
  FrameCamera camera_;
  SeenSurfaces seen_;
  std::vector<Hit> hits_;
};

}  // namespace tempolux
