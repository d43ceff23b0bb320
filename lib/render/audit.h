// lib/render/audit.h -- measures the bias of a frame's layers by photons and by camera paths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/render/frame_renderer.h"
#include "lib/render/photon_splats.h"

namespace tempolux {

/// An estimate with its standard error. error < 0: nothing is known.
struct Estimate {
  double value = 0, error = -1;
  bool known() const { return error >= 0; }
};

/// One layer in one part of the picture. Radiances [W/m^2/sr] are means over the part's pixels and channels.
struct AuditEntry {
  Layer layer = Layer::indirect;
  std::string part;              ///< "picture", "tile 2 3" (column, row of 4 x 4) or "object N"
  std::uint32_t object = kNone;  ///< id.object
  std::size_t pixels = 0;
  double shown = 0;  ///< radiance of the frame
  Estimate splats;   ///< radiance estimated by splats of photons
  Estimate paths;    ///< radiance estimated by camera paths: `shown` minus the bias that paths find
  Estimate bias;     ///< bias of the frame, estimated from splats and paths together
  /// The whole picture's radiance of all layers, times its pixels over the part's pixels: `bias` is reported as a share
  /// of this.
  double picture = 0;
  double share() const { return picture > 0 ? bias.value / picture : 0; }
  double share_error() const { return picture > 0 ? bias.error / picture : 0; }
  double of_layer() const { return shown - bias.value > 0 ? bias.value / (shown - bias.value) : 0; }
  double of_layer_error() const { return shown - bias.value > 0 ? bias.error / (shown - bias.value) : 0; }
};

/// Number of paths that an audit traces, from the lights and from the camera.
struct AuditEffort {
  std::uint64_t photon_paths = 0;  ///< rounded up to a multiple of FrameAudit::kMaps
  std::size_t eye_paths = 0;
  std::uint64_t seed = 0;
};

/// The effort that costs about `share` of a frame's rays, half of it for photons.
AuditEffort audit_effort(double share, const RayCounts& rays, std::uint64_t seed);

/// Audits the layers direct, caustic and indirect of a frame in two ways: by photons of its own that the camera sees,
/// and by camera paths.
///
/// The standard error of the photons' estimate is that of the mean of kMaps photon maps. Each map has its own seed, so
/// the maps are independent and equally distributed, however the starts within one map are stratified. An estimate is
/// not reported if one map or path holds more than half of its sum of squares, or if its photons or its paths' light
/// count for fewer than 32 equal photons or paths, by (sum)^2 / sum of squares. Paths alone cannot know that a frame is
/// too bright: they may miss rare light.
class FrameAudit {
 public:
  static constexpr std::size_t kMaps = 32;

  /// objects: id.object by pixel. Pixels with mask 0 are not audited. All arguments must outlive the audit.
  FrameAudit(const CameraView& view, const RenderedFrame& frame, std::span<const std::uint32_t> objects,
             std::span<const std::uint8_t> mask);
  /// Traces kMaps photon maps with effort.photon_paths light paths in all, and adds the photons that the camera sees.
  /// `lights` may aim photons.
  void add_photons(const Tracer& tracer, const Lights& lights, const AuditEffort& effort);
  /// Starts effort.eye_paths camera rays, spread over the picture. At each first hit, adds the difference between the
  /// frame's estimate of light and a camera path's estimate. So bias is found also where no photon is in view. `scene`
  /// and `options` are those that the frame was rendered with.
  void add_paths(const RenderScene& scene, const FrameOptions& options, const AuditEffort& effort);
  /// Entries of all layers that have an estimate: of the picture, the tiles and the objects, in this order.
  std::vector<AuditEntry> entries() const;

 private:
  struct Part {
    std::string name;
    std::uint32_t object = kNone;
    std::size_t pixels = 0;
  };
  /// Sums over one part of the picture, by layer.
  struct Sums {
    std::array<double, kLayerCount> shown{};
    std::array<std::array<float, kMaps>, kLayerCount> splats{};  ///< by map
    std::array<double, kLayerCount> splats_square{};  ///< sum of the squares of the single photons' contributions
    std::array<double, kLayerCount> paths{}, paths_square{}, paths_largest{};
    std::size_t path_count = 0;
    std::array<double, kLayerCount> found{}, found_square{};  ///< light that paths found
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

/// True if the entry is to be reported: a layer's bias over the picture above 2 % of the picture's light and above
/// three standard errors.
bool is_biased(const AuditEntry& entry);
inline constexpr double kAuditLimit = 0.02, kAuditErrors = 3;

}  // namespace tempolux
