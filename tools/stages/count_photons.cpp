#include "tools/stages/count_photons.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/core/arrays.h"
#include "lib/points/gather_points.h"
#include "lib/temporal/light_jumps.h"
#include "tools/common/cli.h"

namespace tempolux::tools {
namespace {

constexpr const char* kKinds[] = {"direct", "caustic", "indirect"};

bool wants(const CountOptions& options, formats::PathKind kind) {
  return std::size_t(kind) < 3 && std::ranges::find(options.kinds, kKinds[std::size_t(kind)]) != options.kinds.end();
}

/// A power of two, about 2^-44 of the flux of all lights: a sum then holds 2^19 times that flux.
double unit_of(double emitted) {
  return std::exp2(std::clamp(std::ceil(std::log2(std::max(emitted, 1e-300))), -900.0, 900.0) - 44);
}

std::string kinds_text(const CountOptions& options) {
  std::string text;
  for (const char* kind : kKinds)
    if (std::ranges::find(options.kinds, kind) != options.kinds.end())
      text += (text.empty() ? "" : ",") + std::string(kind);
  return text;
}

formats::PhotonMap read_map(Tool& tool, const std::string& name, const SceneFrame& frame, const CountOptions& options) {
  const auto wanted = [&](const formats::PhotonHeader&, const formats::Photon& photon) {
    return wants(options, photon.kind);
  };
  formats::PhotonMap map = formats::load_photons(name, wanted);
  tool.depends_on(name);
  check_identity(tool, name, map.header.identity, frame);
  if (map.header.map != "global" || !map.header.part.empty())
    throw InputError(name + ": holds a part of the light (" +
                     (map.header.part.empty() ? map.header.map : map.header.part) + "); name a global map");
  for (const std::string& kind : options.kinds)
    if (!holds_kind(map.header.kinds, kind))
      throw InputError(name + ": has no photons of kind " + kind + "; trace them with --kinds, or leave the kind out");
  return map;
}

/// Other frames of a frame's segment, each evaluated once.
class SegmentFrames {
 public:
  SegmentFrames(SceneInput& input, const SceneFrame& frame) : input_(input), frame_(frame) {}
  /// nullptr outside the segment.
  const SceneFrame* at(int number) {
    if (number == frame_.frame) return &frame_;
    if (number < frame_.segment.first || number > frame_.segment.last) return nullptr;
    const auto [found, is_new] = others_.try_emplace(number);
    if (is_new) found->second = input_.at(number, false);
    return &found->second;
  }
  /// Frames whose shapes determine the size of elements: for moving surfaces the first, middle and last frame.
  std::vector<const SceneFrame*> measured() {
    const Segment& s = frame_.segment;
    return {at(s.first), at(s.first + (s.last - s.first) / 2), at(s.last)};
  }
  bool jump() {
    const int f = frame_.frame;
    return light_jumps({at(f - 2), at(f - 1), at(f), at(f + 1)});
  }

 private:
  SceneInput& input_;
  const SceneFrame& frame_;
  std::map<int, SceneFrame> others_;
};

}  // namespace

void add_count_options(Tool& tool, CountOptions& options) {
  tool.file_option("--photons", options.photons, ".photons file of the frame, or a pattern");
  tool.list_option("--kinds", options.kinds,
                   "kinds of light that are counted: direct,caustic,indirect; frame-render takes indirect, or "
                   "caustic,indirect without a map")
      ->check(CLI::IsMember({"direct", "caustic", "indirect"}));
  tool.number_option("--cell", options.mesh.cell, 0, kNoLimit, "longest edge of an element, m; 0: the filter's width");
}

CountedPhotons count_photons(Tool& tool, SceneInput& input, const CountOptions& options, const Tracer& tracer) {
  const SceneFrame& frame = tracer.frame();
  tool.stats().phase("read photons");
  const std::string name = frame_name(options.photons, frame.frame);
  const formats::PhotonMap map = read_map(tool, name, frame, options);
  tool.stats().phase("count", true);
  SegmentFrames segment(input, frame);
  CountedPhotons counted;
  auto& [file, mesh] = counted;
  std::vector<const SceneFrame*> measured{&frame};
  if (options.for_windows) measured = segment.measured();
  // Widths for windows follow from the number of light paths and not from the stored photons, so they are equal in all
  // frames of a segment.
  mesh = options.for_windows ? with_widths(options.mesh, surface_area(*measured.front()),
                                           double(map.header.emitted_count) * options.frames, kCellOfWindows)
                             : with_widths(options.mesh, surface_area(frame), double(map.photons.size()));
  const auto& emitted = map.totals.emitted_flux;
  MeshSums sums(tracer, MeshCuts(mesh.cell, measured), unit_of(emitted[0] + emitted[1] + emitted[2]));
  sums.add(map.photons, Vec3(shift_of(map.header.origin, frame)));
  file.elements = all_elements(frame, sums.cuts());
  put_sums(sums, file.elements);
  file.header.history = map.header.history;
  file.header.identity = identity_of(frame);
  file.header.origin = array_of(frame.origin);
  file.header.cell = mesh.cell;
  file.header.unit = sums.unit();
  file.header.kinds = kinds_text(options);
  if (options.for_windows) {
    file.header.holds = formats::MeshHolds::counts;
    file.header.jump = segment.jump();
    leave_out_dark(file.elements);
  }
  if (sums.lost() * 100 > map.photons.size())
    tool.warn(name + ": no surface was found for " + std::to_string(sums.lost()) + " of " +
              std::to_string(map.photons.size()) + " photons");
  tool.stats().count("photons", double(map.photons.size()));
  tool.stats().count("lost_photons", double(sums.lost()));
  return counted;
}

void write_mesh(Tool& tool, const formats::MeshirradFile& file, Output& output) {
  tool.stats().phase("write");
  formats::write_meshirrad(output.sink(), file);
  output.commit();
  tool.stats().end_phase();
  tool.stats().count("elements", double(file.elements.size()));
}

}  // namespace tempolux::tools
