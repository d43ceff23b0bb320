// tempolux-info on .meshirrad: facts, difference.
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/meshirrad/meshirrad.h"
#include "tools/info/info_difference.h"

namespace tempolux::tools {
namespace {

using namespace formats;

Facts header_facts(const MeshirradHeader& header) {
  return {{"kinds", header.kinds}, {"origin_m", header.origin}, {"cell_m", header.cell}, {"unit_W", header.unit}, {"filter", header.filter}};
}

/// Photons, flux and irradiance of all elements, or of some.
struct Sum {
  std::uint64_t elements = 0, photons = 0;
  double area = 0;
  std::array<double, 3> counted{}, filtered{};   ///< W: by sums, by irradiance times area
  void add(const MeshElement& e, double unit) {
    ++elements;
    photons += e.photons;
    area += double(e.area);
    for (std::size_t c = 0; c < 3; ++c) {
      counted[c] += double(e.sums[c]) * unit;
      filtered[c] += double(e.irradiance[c]) * double(e.area);
    }
  }
  Facts facts() const {
    return {{"elements", elements}, {"photons", photons}, {"area_m2", area}, {"counted_flux_W", counted}, {"filtered_flux_W", filtered}};
  }
};

}  // namespace

Facts meshirrad_facts(const std::string& path) {
  const MeshirradFile file = load_meshirrad(path);
  Facts facts = {{"file", path}, {"type", "meshirrad"}, {"history", lines_of(file.header.history)}};
  facts["identity"] = identity_facts(file.header.identity);
  facts.update(header_facts(file.header));
  Sum all;
  std::map<std::uint16_t, Sum> by_object;
  for (const MeshElement& e : file.elements) {
    all.add(e, file.header.unit);
    by_object[e.object].add(e, file.header.unit);
  }
  facts.update(all.facts());
  facts["by_object"] = Facts::array();
  for (const auto& [object, sum] : by_object) {
    Facts line = {{"object", object}};
    line.update(sum.facts());
    facts["by_object"].push_back(line);
  }
  facts["digest"] = digest_of(file);
  return facts;
}

Facts meshirrad_difference(const std::string& a, const std::string& b) {
  return difference_of_files("meshirrad", a, b, load_meshirrad, header_facts, &MeshirradFile::elements);
}

}  // namespace tempolux::tools
