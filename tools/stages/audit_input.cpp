#include "tools/stages/audit_input.h"

#include <algorithm>

#include "formats/error.h"
#include "lib/scene/standing.h"

namespace tempolux::tools {
namespace {

bool holds(const std::string& kinds, const std::string& kind) {
  return ("," + kinds + ",").find("," + kind + ",") != std::string::npos;
}

void check_maps(const std::vector<std::string>& names, std::vector<std::string> maps) {
  std::ranges::sort(maps);
  if (maps == std::vector<std::string>{"global"} || maps == std::vector<std::string>{"dynamic", "static"}) return;
  throw InputError(names.front() + ": --audit needs all light: one map of photon-trace --map global, or --audit STATIC,DYNAMIC");
}

}  // namespace

AuditPhotons audit_photons(Tool& tool, const std::vector<std::string>& files, const SceneFrame& frame, int number) {
  AuditPhotons photons;
  photons.holds = {};
  photons.holds[std::size_t(Layer::direct)] = photons.holds[std::size_t(Layer::caustic)] = photons.holds[std::size_t(Layer::indirect)] = true;
  std::vector<std::string> names, maps;
  for (const std::string& file : files) {
    const std::string name = frame_name(file, number);
    tool.depends_on(name);
    const formats::PhotonReader reader(name, {.digest = false});
    const formats::PhotonHeader& header = reader.header();
    if (!header.part.empty()) throw InputError(name + ": holds the " + header.part + " part of the light alone (photonmap-split); --audit needs the whole");
    if (header.map == "static") check_identity(tool, name, header.identity, standing_scene(frame));
    else check_identity(tool, name, header.identity, frame);
    for (const Layer layer : {Layer::direct, Layer::caustic, Layer::indirect})
      photons.holds[std::size_t(layer)] = photons.holds[std::size_t(layer)] && holds(header.kinds, kLayerNames[std::size_t(layer)]);
    maps.push_back(header.map);
    names.push_back(name);
  }
  check_maps(names, maps);
  photons.for_each_block = [names, origin = frame.origin](const AuditPhotons::Body& body) {
    for (const std::string& name : names) {
      formats::PhotonReader reader(name, {.digest = false});
      const std::array<double, 3>& from = reader.header().origin;
      const Vec3d shift = Vec3d{from[0], from[1], from[2]} - origin;
      for (formats::PhotonBlock block; reader.read_block(block);) body(block, shift);
    }
  };
  return photons;
}

}  // namespace tempolux::tools
