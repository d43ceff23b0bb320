// lib/report/report_page.h -- the report as Markdown and as one HTML file.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lib/report/scene_report.h"

namespace tempolux {

/// Bytes of the drawn plots by file name ("error-S2.svg").
using Plots = std::map<std::string, std::string>;

/// The report in Markdown: tables, and links to the plots that exist.
std::string report_markdown(const ReportInput& input, const std::vector<SceneReport>& scenes, const Plots& plots);

/// The report as one HTML file, which contains the plots as data URIs.
std::string report_html(const ReportInput& input, const std::vector<SceneReport>& scenes, const Plots& plots);

}  // namespace tempolux
