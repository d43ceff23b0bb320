// lib/render/audit.h -- measures the bias of a frame's layers with light of its own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/core/statistics.h"
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
  Estimate light;    ///< radiance that the audit found
  Estimate bias;     ///< `shown` minus `light`; 3 errors are as rare as for a normal variable
  /// The whole picture's radiance of all layers, times its pixels over the part's pixels: `bias` is reported as a share
  /// of this.
  double picture = 0;
  double share() const { return picture > 0 ? bias.value / picture : 0; }
  double share_error() const { return picture > 0 ? bias.error / picture : 0; }
  double of_layer() const { return shown - bias.value > 0 ? bias.value / (shown - bias.value) : 0; }
  double of_layer_error() const { return shown - bias.value > 0 ? bias.error / (shown - bias.value) : 0; }
};

/// Number of paths that an audit traces, from the lights and from the camera, rounded up to a multiple of
/// FrameAudit::kAudits.
struct AuditEffort {
  std::uint64_t photon_paths = 0;
  std::size_t eye_paths = 0;
  std::uint64_t seed = 0;
};

/// The effort that costs about `share` of a frame's rays, half of it for photons if there are both photons and paths.
AuditEffort audit_effort(double share, const RayCounts& rays, bool photons, bool paths, std::uint64_t seed);

/// Audits the layers direct, caustic and indirect of a frame: finds their light again, without files of light. Each
/// light is found in one way, by photons that the camera sees (add_photons) or by camera paths (add_paths). So the
/// lights of the two calls together must be those of the scene.
///
/// The effort is divided into kAudits independent audits with seeds of their own. The standard error is that of their
/// mean, however paths and starts are stratified within each audit. For paths nothing is reported if few contributions
/// hold most of the variance: if (sum of c^2)^2 / sum of c^4 is below 32 for the contributions c of single photons and
/// paths. This number of effective contributions gives the variance a relative standard error of 18 %.
///
/// Photons close to the camera are rare and bright. Audits that happened to meet none of them find too little light and
/// a standard error that is too small. So where photons find all light, the error of a bias is at least the one that
/// photons would have if the frame were right: each pixel's light L arrives by photons of contribution c, whose number
/// is Poisson distributed, so the variance of the sum is the sum of L c. Such entries are always reported: to report
/// only audits that met no bright photon would select those that found too little.
class FrameAudit {
 public:
  static constexpr std::size_t kAudits = 32;

  /// objects: id.object by pixel. Pixels with mask 0 are not audited. All arguments must outlive the audit.
  FrameAudit(const CameraView& view, const RenderedFrame& frame, std::span<const std::uint32_t> objects,
             std::span<const std::uint8_t> mask);
  /// Adds the photons of effort.photon_paths light paths from `lights` that the camera sees. `lights` may aim photons.
  void add_photons(const Tracer& tracer, const Lights& lights, const AuditEffort& effort);
  /// Adds the light of scene.lights that effort.eye_paths camera paths find, spread over the picture.
  void add_paths(const RenderScene& scene, const AuditEffort& effort);
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
    std::array<std::array<double, kAudits>, kLayerCount> light{};  ///< that each audit found
    std::array<double, kLayerCount> square{}, fourth{};            ///< of single contributions: sums of powers
    std::array<double, kLayerCount> expected{};                    ///< variance of the light if the frame were right
  };
  template <class Body>
  void for_parts_of(std::size_t pixel, const Body& body) const;
  void add(std::size_t audit, std::size_t pixel, std::size_t layer, double radiance);
  void expect(const Tracer& tracer, const PhotonSplats& camera, const std::array<double, kLayerCount>& flux);
  AuditEntry entry(std::size_t part, std::size_t layer) const;

  const CameraView& view_;
  const RenderedFrame& frame_;
  std::span<const std::uint8_t> mask_;
  std::vector<Part> parts_;                 ///< picture, 16 tiles, objects
  std::vector<std::uint32_t> object_part_;  ///< by pixel
  std::vector<Sums> sums_;                  ///< by part
  double picture_ = 0;                      ///< sum over pixels of mean_to_white()
};

/// True if the entry is to be reported: a layer's bias over the picture above 2 % of the picture's light and above
/// three standard errors.
bool is_biased(const AuditEntry& entry);
inline constexpr double kAuditLimit = 0.02, kAuditErrors = kCertain;
/// A second, independent audit decides whether a biased entry is reported; it has this many times the effort.
inline constexpr int kAuditAgain = 4;

}  // namespace tempolux
