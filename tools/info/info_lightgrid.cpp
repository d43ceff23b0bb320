// tools/info/info_lightgrid.cpp -- tempolux-info on .lightgrid: facts, difference.
#include <nlohmann/json.hpp>
#include <string>

#include "formats/lightgrid/lightgrid.h"
#include "tools/info/info_difference.h"

namespace tempolux::tools {
namespace {

using namespace formats;

Facts header_facts(const LightgridHeader& header) {
  return {{"origin_m", header.origin}, {"edge_m", header.edge}, {"parts", header.parts}};
}

}  // namespace

Facts lightgrid_facts(const std::string& path) {
  const LightgridFile file = load_lightgrid(path);
  Facts facts = {{"file", path}, {"type", "lightgrid"}, {"history", lines_of(file.header.history)}};
  facts["identity"] = identity_facts(file.header.identity);
  facts.update(header_facts(file.header));
  double sky = 0, suns = 0;
  std::array<std::size_t, 6> facing{};
  for (const LightgridCell& cell : file.cells) {
    sky += double(cell.sky) / double(file.cells.size());
    suns += double(cell.suns) / double(file.cells.size());
    ++facing[cell.facing];
  }
  facts.update({{"cells", file.cells.size()}, {"mean_to_sky", sky}, {"mean_to_suns", suns}});
  facts["cells_by_facing"] = facing;
  facts["digest"] = digest_of(file);
  return facts;
}

Facts lightgrid_difference(const std::string& a, const std::string& b) {
  return difference_of_files("lightgrid", a, b, load_lightgrid, header_facts, &LightgridFile::cells);
}

}  // namespace tempolux::tools
