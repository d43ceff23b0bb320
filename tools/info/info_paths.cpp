// tools/info/info_paths.cpp -- tempolux-info on .paths: facts.
#include <string>
#include <vector>

#include "formats/paths/paths.h"
#include "lib/core/json.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {
namespace {

using namespace formats;

/// Number of paths by interval.
std::vector<std::uint64_t> counts_of(const PathsFile& file) {
  std::vector<std::uint64_t> counts(file.header.movers.size());
  for (const TouchedPath& path : file.paths)
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += (path.intervals >> i) & 1;
  return counts;
}

}  // namespace

Facts paths_facts(const std::string& path) {
  const PathsFile file = load_paths(path);
  const PathsHeader& header = file.header;
  Facts facts = start_of(path, "paths", header.history, header.identity);
  facts.update({{"kinds", header.kinds},
                {"origin_m", header.origin},
                {"groups", header.group_count},
                {"emitted_paths", header.emitted_count},
                {"seed", header.seed},
                {"intervals", header.movers.size()},
                {"touched_paths", file.paths.size()},
                {"by_interval", counts_of(file)},
                {"digest", digest_of(file)}});
  return facts;
}

}  // namespace tempolux::tools
