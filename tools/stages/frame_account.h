// tools/stages/frame_account.h -- reports a frame's error: in stats, in its header and on the terminal.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lib/audit/advice.h"
#include "lib/audit/audit.h"
#include "lib/render/frame_renderer.h"
#include "lib/render/still_pixels.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// Figures under the names of formats/frames/frames.md and formats/stats/stats.md, for instance "noise.direct.codes".
/// Empty if the frame's noise is unknown. audit: entries of FrameAudit, if there was an audit.
std::map<std::string, double> account_of(const RenderedFrame& rendered, const std::vector<AuditEntry>& audit);

/// --still: joins the noise of the pixels that were sampled anew with the noise of the frame `from`, which gives the
/// kept pixels. share_anew: share of the new pixels. Variances are means over pixels. The noise of `from` is read from
/// its own account.
void add_noise_of_kept(const Image& from, const StillPixels& still, FrameNoise& noise);

/// Reports the figures: in --stats, as lines with --verbose, as a warning if `asked` (FrameOptions::seen_error) was not
/// reached, and as a warning for each biased layer (is_biased). object_names: the names in the scene's file, by
/// id.object. lit: what advice on a bias is about.
void report_account(Tool& tool, const RenderedFrame& rendered, const std::vector<AuditEntry>& audit,
                    const FrameOptions& asked, const std::vector<std::string>& object_names, LitBy lit);

}  // namespace tempolux::tools
