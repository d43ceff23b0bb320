// lib/report/gnuplot.cpp -- runs gnuplot as a child process.
#include "lib/report/gnuplot.h"

#include "formats/error.h"
#include "lib/core/child_process.h"

namespace tempolux {

std::optional<std::string> run_gnuplot(const std::string& script, int timeout_s) {
  constexpr const char* kMissing = "ended with code 127";
  ChildLimits limits;
  limits.memory_bytes = 4ull << 30;
  limits.file_bytes = 64ull << 20;  // its library of fonts writes a cache
  limits.processor_s = limits.wall_s = timeout_s;
  // -d ignores the user's settings, so that equal input gives equal plots.
  const ChildResult result =
      run_child("/bin/sh", {"-c", "command -v gnuplot >/dev/null || exit 127; exec gnuplot -d -"},
                {reinterpret_cast<const unsigned char*>(script.data()), script.size()}, limits);
  if (result.trouble == kMissing) return std::nullopt;
  if (!result.trouble.empty() || result.output.empty())
    throw ResourceError("gnuplot: failed: " + result.trouble + " " + result.words);
  return std::string(result.output.begin(), result.output.end());
}

}  // namespace tempolux
