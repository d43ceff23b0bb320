// tools/info/info_radsamples.cpp -- tempolux-info on .radsamples: facts.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "formats/radsamples/radsamples.h"
#include "lib/core/json.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {
namespace {

using namespace formats;

Facts header_facts(const RadsamplesFile& file) {
  Facts facts = {{"columns", file.header.anchors ? "anchor" : "none"},
                 {"origin_m", file.header.origin},
                 {"diagonal_m", file.header.diagonal},
                 {"segment", file.header.segment}};
  if (file.header.anchors) facts["points_hash"] = file.header.points_hash;
  if (!file.header.high_hash.empty()) facts["part"] = "low", facts["high_hash"] = file.header.high_hash;
  facts["points"] = file.point_light.size();
  facts["records"] = file.records.size();
  facts["samples"] = file.samples.size();
  return facts;
}

/// Share of the samples for which `is` returns true.
template <class Is>
double share(const RadsamplesFile& file, const Is& is) {
  if (file.samples.empty()) return 0;
  return double(std::count_if(file.samples.begin(), file.samples.end(), is)) / double(file.samples.size());
}

Facts age_facts(const RadsamplesFile& file) {
  std::vector<std::uint64_t> ages;
  double sum = 0;
  for (const RadianceSample& sample : file.samples) {
    if (age_of(sample) >= ages.size()) ages.resize(age_of(sample) + 1u);
    ++ages[age_of(sample)];
    sum += age_of(sample);
  }
  if (ages.empty()) return nullptr;
  return {{"mean", sum / double(file.samples.size())},
          {"largest", ages.size() - 1},
          {"share_above_10", share(file, [](const RadianceSample& s) { return age_of(s) > 10; })},
          {"samples_by_age", ages}};
}

}  // namespace

Facts radsamples_facts(const std::string& path) {
  const RadsamplesFile file = load_radsamples(path);
  Facts facts = start_of(path, "radsamples", file.header.history, file.header.identity);
  facts.update(header_facts(file));
  facts["age"] = age_facts(file);
  const auto has = [&](SampleFlags flag) {
    return share(file, [flag](const RadianceSample& s) { return (s.flags & flag) != 0; });
  };
  facts["share_of_samples"] = {{"valid", has(sample_valid)},
                               {"dynamic", has(sample_dynamic)},
                               {"miss", has(sample_miss)},
                               {"near", has(sample_near)},
                               {"anchored", has(sample_anchored)}};
  std::array<std::uint64_t, 2> by_set{};
  std::uint64_t fading = 0, updates = 0;
  for (const RadsamplesRecord& record : file.records) {
    ++by_set[std::size_t(record.set)];
    fading += record.fading > 0;
    updates = std::max<std::uint64_t>(updates, record.updates);
  }
  facts["by_set"] = {{"static", by_set[0]}, {"dynamic", by_set[1]}};
  facts["fading_records"] = fading;
  facts["most_updates"] = updates;
  facts["digest"] = digest_of(file);
  return facts;
}

}  // namespace tempolux::tools
