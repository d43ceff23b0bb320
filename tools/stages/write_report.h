// tools/stages/write_report.h -- what error-report does.
#pragma once

#include <string>
#include <vector>

#include "tools/common/tool_main.h"

namespace tempolux::tools {

struct ReportOptions {
  std::string manifest, folder = "report", title;
  std::vector<std::string> runs;
};

/// Reads the runs, draws the plots and writes the report's folder. Returns the exit code. Throws InputError.
int write_report(Tool& tool, const ReportOptions& o);

}  // namespace tempolux::tools
