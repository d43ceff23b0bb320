// tools/info/info_paths.cpp -- tempolux-info on .paths: facts, difference.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/paths/paths.h"
#include "tools/info/info_difference.h"

namespace tempolux::tools {
namespace {

using namespace formats;

/// The header without history and identity.
Facts header_facts(const PathsHeader& header) {
  return {{"kinds", header.kinds},        {"origin_m", header.origin},
          {"groups", header.group_count}, {"emitted_paths", header.emitted_count},
          {"seed", header.seed},          {"intervals", header.movers.size()}};
}

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
  Facts facts = {{"file", path}, {"type", "paths"}, {"history", lines_of(file.header.history)}};
  facts["identity"] = identity_facts(file.header.identity);
  facts.update(header_facts(file.header));
  facts["touched_paths"] = file.paths.size();
  facts["by_interval"] = counts_of(file);
  facts["digest"] = digest_of(file);
  return facts;
}

Facts paths_difference(const std::string& a, const std::string& b) {
  return difference_of_files("paths", a, b, load_paths, header_facts, &PathsFile::paths);
}

}  // namespace tempolux::tools
