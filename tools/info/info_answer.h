// tools/info/info_answer.h -- tempolux-info: answers a request with text, JSON, a picture or points.
#pragma once

#include <string>
#include <vector>

#include "tools/common/tool_main.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {

struct Request {
  std::vector<std::string> files;
  bool check = false, whole = false, digest = false, diff = false, json = false, account = false;
  std::string exported, png, sheet, scene;
  PictureOptions picture;

  /// The file to write, by the one option that names it; "": none.
  const std::string& written() const { return !sheet.empty() ? sheet : !png.empty() ? png : exported; }
};

/// Answers the request on standard output, or in the file that the request names. Returns the exit code: exit_differs
/// if --check or --whole finds a file that is not valid, or --diff finds different data. Throws InputError for bad
/// usage.
int answer(Tool& tool, Request& request);

}  // namespace tempolux::tools
