// tools/info/info_meshirrad.cpp -- tempolux-info on .meshirrad: facts.
#include <map>
#include <string>

#include "formats/meshirrad/meshirrad.h"
#include "formats/record_statistics.h"
#include "lib/core/json.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {
namespace {

using namespace formats;

Facts header_facts(const MeshirradHeader& header) {
  Facts facts = {
      {"kinds", header.kinds},   {"origin_m", header.origin},
      {"cell_m", header.cell},   {"unit_W", header.unit},
      {"filter", header.filter}, {"holds", std::array{"frame", "counts", "windows"}[std::size_t(header.holds)]}};
  if (header.holds == MeshHolds::counts) facts["jump"] = header.jump;
  return facts;
}

/// Number of frames in the windows of elements with photons, and how many frames the middle of a window lies after
/// its own frame, on average.
Facts window_facts(const MeshirradFile& file) {
  Spread frames, age;
  for (const MeshElement& e : file.elements) {
    if (e.photons == 0) continue;
    frames.add(e.before + 1 + e.after);
    age.add((double(e.after) - double(e.before)) / 2);
  }
  if (frames.count == 0) return Facts::object();
  return {{"window_frames", spread_facts(frames)}, {"window_shift_frames", spread_facts(age)}};
}

/// Photons, flux and irradiance of a set of elements.
struct Sum {
  std::uint64_t elements = 0, photons = 0;
  double area = 0;
  std::array<double, 3> counted{}, filtered{};  ///< W: from the counts per frame; from irradiance times area
  void add(const MeshElement& e, double unit) {
    ++elements;
    photons += e.photons;
    area += double(e.area);
    for (std::size_t c = 0; c < 3; ++c) {
      counted[c] += double(e.sums[c]) * unit / (e.before + 1 + e.after);
      filtered[c] += double(e.irradiance[c]) * double(e.area);
    }
  }
  Facts facts() const {
    return {{"elements", elements},
            {"photons", photons},
            {"area_m2", area},
            {"counted_flux_W", counted},
            {"filtered_flux_W", filtered}};
  }
};

}  // namespace

Facts meshirrad_facts(const std::string& path) {
  const MeshirradFile file = load_meshirrad(path);
  Facts facts = start_of(path, "meshirrad", file.header.history, file.header.identity);
  facts.update(header_facts(file.header));
  Sum all;
  std::map<std::uint16_t, Sum> by_object;
  for (const MeshElement& e : file.elements) {
    all.add(e, file.header.unit);
    by_object[e.object].add(e, file.header.unit);
  }
  facts.update(all.facts());
  if (file.header.holds == MeshHolds::windows) facts.update(window_facts(file));
  facts["by_object"] = Facts::array();
  for (const auto& [object, sum] : by_object) {
    Facts line = {{"object", object}};
    line.update(sum.facts());
    facts["by_object"].push_back(line);
  }
  facts["digest"] = digest_of(file);
  return facts;
}

}  // namespace tempolux::tools
