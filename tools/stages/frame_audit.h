// tools/stages/frame_audit.h -- light that a rendered frame lacks: measures it, warns of it, adds it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lib/audit/audit.h"
#include "lib/light/lights.h"
#include "lib/render/frame_renderer.h"
#include "tools/common/tool_main.h"
#include "tools/stages/render_frame.h"

namespace tempolux::tools {

/// A rendered frame, with the scene, the lights, the view and the options that it was rendered from.
struct AuditedFrame {
  const RenderScene& scene;
  const EmissionTable& emission;
  const CameraView& view;
  const FrameOptions& options;
  const RenderedFrame& rendered;
  std::uint64_t light_paths = 0;  ///< of add_light_without_paths

  mutable std::optional<double> hidden = {};  ///< the result of hidden_light(), once it is known

  /// These lights, with distant light aimed at what the camera sees.
  Lights aimed(Lights::Which which) const;
  /// Share of the picture that point, spot and sun lights bring by way of mirrors and smooth glass (hidden_share()).
  /// Photons measure the share at the first call.
  double hidden_light() const;
};

/// Warns if the frame lacks light of point, spot and sun lights that mirrors or smooth glass send on: no camera path
/// finds such light. A frame by path tracing is warned of in any case. For other frames photons measure the missing
/// light, and a share that an audit tolerates gives no warning.
void warn_of_missing_light(Tool& tool, const AuditedFrame& made);

/// Measures the bias of the frame's layers, with photons or camera paths of its own:
/// - Light of lamps: photons, because few camera paths meet a bright spot close to a lamp. Photons are also looked at
///   in mirrors and glass (SpecularHits).
/// - Light of sun and sky: camera paths, because few photons of sun and sky arrive in view.
/// - All light if the scene has a sun, maybe in a map of light, and a mirror or smooth glass that is no pane or plate:
///   photons, because no camera path meets a sun via a smooth surface.
/// If only camera paths are needed and the frame was rendered by paths, nothing is measured and `unbiased` becomes
/// true.
std::vector<AuditEntry> audit(Tool& tool, const RenderOptions& options, const AuditedFrame& made, bool& unbiased);

/// --light-paths: adds the light that no camera path finds to the picture, or to both halves and their mean.
void add_light_without_paths(Tool& tool, const RenderOptions& options, const AuditedFrame& made,
                             RenderedFrame& rendered);

}  // namespace tempolux::tools
