// tempolux-info on .paths: facts, difference.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/paths/paths.h"
#include "tools/common/info_facts.h"

namespace tempolux::tools {
namespace {

using namespace formats;

/// The header but for history and identity.
Facts header_facts(const PathsHeader& header) {
  return {{"kinds", header.kinds},   {"origin_m", header.origin}, {"groups", header.group_count},
          {"emitted_paths", header.emitted_count}, {"seed", header.seed}, {"intervals", header.movers.size()}};
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
  const PathsFile file_a = load_paths(a), file_b = load_paths(b);
  const std::string digest_a = digest_of(file_a), digest_b = digest_of(file_b);
  Facts facts = {{"files", {a, b}}, {"type", "paths"}, {"equal", digest_a == digest_b}, {"differing", Facts::object()}};
  const Facts of_a = header_facts(file_a.header), of_b = header_facts(file_b.header);
  for (const auto& [key, value] : of_a.items())
    if (of_b[key] != value) facts["differing"][key] = {value, of_b[key]};
  const std::size_t records = std::min(file_a.paths.size(), file_b.paths.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < records; ++i) differing += !(file_a.paths[i] == file_b.paths[i]);
  facts["records_compared"] = records;
  facts["records_differing"] = differing;
  facts["digests"] = {digest_a, digest_b};
  return facts;
}

}  // namespace tempolux::tools
