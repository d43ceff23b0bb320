// lib/audit/audit.h -- estimates the bias of a frame's layers by independent photons and camera paths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/core/statistics.h"
#include "lib/render/frame_renderer.h"
#include "lib/audit/photon_splats.h"
#include "lib/audit/specular_hits.h"

namespace tempolux {

/// An estimate with its standard error. error < 0: there is no estimate.
struct AuditedMean {
  double value = 0, error = -1;
  bool known() const { return error >= 0; }
};

/// The bias of one layer in one part of the picture. Radiances [W/m^2/sr] are means over the part's pixels and
/// channels.
struct AuditEntry {
  Layer layer = Layer::indirect;
  std::string part;              ///< "picture", "tile 2 3" (column, row of 4 x 4) or "object N"
  std::uint32_t object = kNone;  ///< id.object
  std::size_t pixels = 0;
  double shown = 0;   ///< radiance of the frame
  AuditedMean light;  ///< radiance that the audit found
  AuditedMean bias;   ///< `shown` minus `light`; exceeds three errors as rarely as a normally distributed number
  /// Sum of all layers over all pixels of the picture (mean_to_white), divided by the part's number of pixels. share()
  /// is `bias` over this radiance, so shares of parts add up.
  double picture = 0;
  /// `bias` over `picture`, and its standard error; 0 for a black picture.
  double share() const { return picture > 0 ? bias.value / picture : 0; }
  double share_error() const { return picture > 0 ? bias.error / picture : 0; }
  /// `bias` over the radiance that the layer should have in the part; 0 if that is not above 0.
  double of_layer() const { return shown - bias.value > 0 ? bias.value / (shown - bias.value) : 0; }
  double of_layer_error() const { return shown - bias.value > 0 ? bias.error / (shown - bias.value) : 0; }
};

/// Numbers of light paths and of camera paths that an audit traces, each rounded up to a multiple of
/// FrameAudit::kAudits.
struct AuditEffort {
  std::uint64_t photon_paths = 0;
  std::size_t eye_paths = 0;
  std::size_t specular_paths = 0;  ///< of SpecularHits
  std::uint64_t seed = 0;
};

/// The effort that costs about `share` of the frame's `rays`. photons, paths, specular: is the light of photons, the
/// light of camera paths, the layer specular audited? Each gets an equal part of the share.
AuditEffort audit_effort(double share, const RayCounts& rays, bool photons, bool paths, bool specular,
                         std::uint64_t seed);

/// Audits the layers direct, caustic and indirect of a frame: estimates their radiance without bias and without files
/// of light, and compares. add_photons() finds the light of some of the scene's lights by photons that the camera sees,
/// add_paths() finds the light of the other lights by camera paths. The two calls together must cover each light of the
/// scene once. The layer specular is audited in the whole picture only, and only its light on surfaces that mirrors and
/// glass show.
///
/// The effort is divided into kAudits independent audits with different seeds. Paths and their starts are stratified
/// within an audit; the standard error comes from the differences between audits, so it includes the gain. There is no
/// entry if few contributions hold most of the variance: if (sum of c^2)^2 / sum of c^4 is below 32 for the
/// contributions c of single photons and paths. This is an effective number of contributions; from 32 contributions the
/// variance has a relative standard error of 18 %.
///
/// Photons close to the camera are rare and bright. Audits that happen to meet none of them find too little light and
/// too small a standard error. Where photons find all light, the error of a bias is therefore at least the error that
/// photons would have if the frame were right. A pixel's light L then arrives by photons of contribution c, their
/// number has a Poisson distribution, and the variance of the sum over pixels is the sum of L c. Such entries
/// exist for any effective number of contributions. If entries with few contributions were left out, the remaining
/// entries would come from audits that met no bright photon, and they would all have too little light.
class FrameAudit {
 public:
  static constexpr std::size_t kAudits = 32;

  /// objects: the object that each pixel shows (channel id.object). Pixels with mask 0 are not audited. camera_inside:
  /// RenderScene's. All arguments must outlive the audit.
  FrameAudit(const CameraView& view, const RenderedFrame& frame, std::span<const std::uint32_t> objects,
             std::span<const std::uint8_t> mask, const Inside& camera_inside = {});
  /// Adds the photons of effort.photon_paths light paths from `lights` that the camera sees (PhotonSplats). `lights`
  /// may aim photons. With `seen`, also adds their light on surfaces that mirrors and glass show.
  void add_photons(const Tracer& tracer, const Lights& lights, const AuditEffort& effort,
                   const SpecularHits* seen = nullptr);
  /// Adds the light of scene.lights that effort.eye_paths camera paths find in pixels all over the picture.
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
    std::array<std::array<double, kAudits>, kLayerCount> light{};  ///< radiance that each audit found
    std::array<double, kLayerCount> square{}, fourth{};            ///< sums of powers of single contributions
    std::array<double, kLayerCount> expected{};                    ///< variance of `light` if the frame were right
  };
  template <class Body>
  void for_parts_of(std::size_t pixel, const Body& body) const;
  void add(std::size_t audit, std::size_t pixel, std::size_t layer, double radiance);
  static void add_to(Sums& sums, std::size_t audit, std::size_t layer, double radiance);
  void expect(const Tracer& tracer, const PhotonSplats& camera, const std::array<double, kLayerCount>& flux);
  AuditEntry entry(std::size_t part, std::size_t layer) const;

  const CameraView& view_;
  const RenderedFrame& frame_;
  std::span<const std::uint8_t> mask_;
  Inside camera_inside_;
  bool specular_ = true;     ///< all light of layer specular was looked for
  double hits_square_ = 0;   ///< sum over SpecularHits of the squares of the light that photons bring to each
  std::vector<Part> parts_;  ///< picture, 16 tiles, objects
  std::vector<std::uint32_t> object_part_;  ///< by pixel
  std::vector<Sums> sums_;                  ///< by part
  double picture_ = 0;                      ///< sum over pixels of mean_to_white()
};

/// Least bias that is reported: over the light of the picture, and in standard errors.
inline constexpr double kAuditLimit = 0.02, kAuditErrors = kCertain;
/// True if the bias of the entry is above both limits.
bool is_biased(const AuditEntry& entry);
/// A second, independent audit decides whether a biased entry is reported; it has this many times the effort.
inline constexpr int kAuditAgain = 4;

}  // namespace tempolux
