// lib/render/audit.h -- the bias of a frame's layers, measured by splats of photons and by paths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/render/frame_renderer.h"
#include "lib/render/photon_splats.h"

namespace tempolux {

/// An estimate with its standard error; error < 0: not known.
struct Estimate {
  double value = 0, error = -1;
  bool known() const { return error >= 0; }
};

/// One layer over one part of the picture. Radiances are means over the part's pixels and channels
/// [W/m^2/sr].
struct AuditEntry {
  Layer layer = Layer::indirect;
  std::string part;              ///< "picture", "tile 2 3" (column, row of 4 x 4) or "object N"
  std::uint32_t object = kNone;  ///< id.object
  std::size_t pixels = 0;
  double shown = 0;    ///< the frame's
  Estimate splats;     ///< by photons
  Estimate paths;      ///< shown minus this is the bias that paths find
  Estimate bias;       ///< of the frame, by the two together
  double picture = 0;  ///< radiance of all layers over the whole picture, times its pixels over the part's: what `bias`
                       ///< is a share of
  double share() const { return picture > 0 ? bias.value / picture : 0; }
  double share_error() const { return picture > 0 ? bias.error / picture : 0; }
  double of_layer() const { return shown - bias.value > 0 ? bias.value / (shown - bias.value) : 0; }
  double of_layer_error() const { return shown - bias.value > 0 ? bias.error / (shown - bias.value) : 0; }
};

/// Paths of light that an audit traces, from the lamps and from the eye.
struct AuditEffort {
  std::uint64_t photon_paths = 0;  ///< rounded up to a multiple of FrameAudit::kMaps
  std::size_t eye_paths = 0;
  std::uint64_t seed = 0;
};

/// Effort of about `share` of the rays of a frame, half of it photons.
AuditEffort audit_effort(double share, const RayCounts& rays, std::uint64_t seed);

/// Audits the layers direct, caustic and indirect of a frame: by photons of the audit's own that the camera sees, and
/// by paths.
///
/// The standard error of what photons say is that of the mean of kMaps photon maps. Each map has a seed of its own, so
/// the maps are independent and of one distribution, however the starts of one map are stratified. An estimate one map
/// (or path) of which holds more than half of the sum of squares has no known error and is not given; nor is one of
/// photons that are worth fewer than 32 equal ones, (sum)^2 / sum of squares.
class FrameAudit {
 public:
  static constexpr std::size_t kMaps = 32;

  /// objects: id.object by pixel. Pixels of `mask` 0 are left out. All must outlive the audit.
  FrameAudit(const CameraView& view, const RenderedFrame& frame, std::span<const std::uint32_t> objects,
             std::span<const std::uint8_t> mask);
  /// Traces kMaps photon maps of effort.photon_paths in all and adds what the camera sees of them. Lights may aim
  /// photons.
  void add_photons(const Tracer& tracer, const Lights& lights, const AuditEffort& effort);
  /// Of effort.eye_paths camera rays, spread over the picture, what the frame's way of finding light says less what
  /// paths find from the same first hit: bias without photons, where none are in view. `scene` and `options` as the
  /// frame was rendered.
  void add_paths(const RenderScene& scene, const FrameOptions& options, const AuditEffort& effort);
  /// Layers that any estimate was made of, over the picture, the tiles and the objects, in this order.
  std::vector<AuditEntry> entries() const;

 private:
  struct Part {
    std::string name;
    std::uint32_t object = kNone;
    std::size_t pixels = 0;
  };
  /// Sums over a part by layer.
  struct Sums {
    std::array<double, kLayerCount> shown{};
    std::array<std::array<float, kMaps>, kLayerCount> splats{};  ///< by map
    std::array<double, kLayerCount> splats_square{};             ///< sum over photons of what each adds, squared
    std::array<double, kLayerCount> paths{}, paths_square{}, paths_largest{};
    std::size_t path_count = 0;
    std::array<std::size_t, kLayerCount> met{};  ///< paths that found light
  };
  template <class Body>
  void for_parts_of(std::size_t pixel, const Body& body) const;
  AuditEntry entry(std::size_t part, std::size_t layer) const;

  const CameraView& view_;
  const RenderedFrame& frame_;
  std::span<const std::uint8_t> mask_;
  std::vector<Part> parts_;                 ///< picture, 16 tiles, objects
  std::vector<std::uint32_t> object_part_;  ///< by pixel
  std::vector<Sums> sums_;                  ///< by part
  double picture_ = 0;                      ///< sum over pixels of the mean channel of all layers
};

/// What is to be said of the entries: bias of a layer over the picture that is above 2 % of the picture's
/// light and above three standard errors.
bool is_biased(const AuditEntry& entry);
inline constexpr double kAuditLimit = 0.02, kAuditErrors = 3;

}  // namespace tempolux
