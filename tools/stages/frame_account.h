// tools/stages/frame_account.h -- what a frame says of its own error: in stats, in its header and on the
// terminal.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lib/render/audit.h"
#include "lib/render/frame_renderer.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// Numbers by the names that formats/frames/frames.md and formats/stats/stats.md give them, for instance
/// "noise.direct.codes". Of a frame whose noise is not known: none.
/// audit: entries of FrameAudit, if there was one.
std::map<std::string, double> account_of(const RenderedFrame& rendered, const std::vector<AuditEntry>& audit);

/// Says them: results of --stats, a line each with --verbose, a warning if `asked` (FrameOptions::seen_error)
/// was not reached, and one for each layer that is biased (is_biased). object_names: by id.object, those of the scene's
/// file.
void say_account(Tool& tool, const RenderedFrame& rendered, const std::vector<AuditEntry>& audit,
                 const FrameOptions& asked, const std::vector<std::string>& object_names);

}  // namespace tempolux::tools
