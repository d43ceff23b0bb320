#include "tools/gather_input.h"

#include "formats/photons/photons.h"
#include "lib/gather/cache_files.h"

namespace tempolux::tools {
namespace {

Vec3d shift_of(const std::array<double, 3>& origin, const SceneFrame& frame) {
  return Vec3d{origin[0], origin[1], origin[2]} - frame.origin;
}

}  // namespace

GatherPoints read_points(Tool& tool, const std::string& file, const SceneFrame& frame) {
  tool.depends_on(file);
  const formats::IrradpointsFile in = formats::load_irradpoints(file);
  check_identity(tool, file, in.header.identity, frame);
  return {from_file(in.records, shift_of(in.header.origin, frame)), float(in.header.spacing), in.header.history,
          in.header.emitted_count};
}

GatherPoints make_points(Tool& tool, const std::string& photons_file, const Tracer& tracer, const Lights& lights,
                         const PointOptions& options) {
  const SceneFrame& frame = tracer.frame();
  tool.depends_on(photons_file);
  const formats::PhotonMap map = formats::load_photons(photons_file);
  check_identity(tool, photons_file, map.header.identity, frame);
  GatherPoints result{place_points(frame, options), point_spacing(frame, options), map.header.history,
                      map.header.emitted_count};
  estimate_points(tracer, lights, map.photons, shift_of(map.header.origin, frame), options, result.points);
  tool.stats().count("points", double(result.points.size()));
  return result;
}

void write_points(Tool& tool, const GatherPoints& points, const SceneFrame& frame, Output& output) {
  formats::IrradpointsHeader header;
  header.history = points.history + tool.history_line(frame.frame);
  header.identity = identity_of(frame);
  header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};
  header.spacing = double(points.spacing);
  header.emitted_count = points.emitted_count;
  formats::IrradpointsWriter writer([&](const void* data, std::size_t size) { output.write(data, size); }, header);
  writer.write(to_file(points.points, frame));
  writer.finish();
  output.commit();
}

std::string read_records(Tool& tool, const std::string& file, const SceneFrame& frame, RecordStore& store) {
  tool.depends_on(file);
  const formats::IrradcacheFile in = formats::load_irradcache(file);
  check_identity(tool, file, in.header.identity, frame);
  for (const IrradianceRecord& record : from_file(in.records, shift_of(in.header.origin, frame))) store.add(record);
  return in.header.history;
}

}  // namespace tempolux::tools
