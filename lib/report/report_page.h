// lib/report/report_page.h -- the report as Markdown and as one HTML file.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lib/report/scene_report.h"

namespace tempolux {

/// The drawn plots by file name ("error-S2.svg"), their bytes.
using Plots = std::map<std::string, std::string>;

/// Tables and links to the plots that are there.
std::string report_markdown(const ReportInput& input, const std::vector<SceneReport>& scenes, const Plots& plots);

/// The same in one file that needs no other: plots, frames, references and difference images as data URIs.
/// Throws InputError if an image named by a run cannot be read or is no PNG.
std::string report_html(const ReportInput& input, const std::vector<SceneReport>& scenes, const Plots& plots);

}  // namespace tempolux
