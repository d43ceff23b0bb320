#include "tools/stages/light_grid_file.h"

#include <algorithm>

#include "formats/lightgrid/lightgrid.h"

namespace tempolux::tools {

using formats::LightgridCell;
static_assert(LightgridCell::kFarthest == LightGrid::kFarthest, "every place of a grid has its place in the file");

void write_light_grid(Tool& tool, const LightGrid* grid, const SceneFrame& frame, Output& output) {
  formats::LightgridFile file;
  file.header.history = tool.history_line(frame.frame);
  file.header.identity = identity_of(frame);
  file.header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};
  file.header.parts = {LightGrid::kAcross, LightGrid::kDown};
  if (grid) {
    file.header.edge = double(grid->edge());
    for (std::size_t i = 0; i < grid->size(); ++i) {
      const LightGrid::Place place = LightGrid::place_of(grid->keys()[i]);
      const LightGrid::Cell& cell = grid->cells()[i];
      file.cells.push_back({place.at, place.facing, cell.sky, cell.suns, {cell.end.begin(), cell.end.end()}});
    }
  }
  formats::write_lightgrid([&](const void* data, std::size_t size) { output.write(data, size); }, file);
  output.commit();
  tool.stats().count("light_cells", double(file.cells.size()));
}

std::unique_ptr<LightGrid> read_light_grid(Tool& tool, const std::string& name, const SceneFrame& frame) {
  tool.depends_on(name);
  const formats::LightgridFile file = formats::load_lightgrid(name);
  if (file.cells.empty()) return nullptr;
  if (file.header.origin != std::array{frame.origin.x, frame.origin.y, frame.origin.z})
    throw InputError(name +
                     ": its cells lie about another origin than this scene's; learn it again with frame-render "
                     "--learn-lights -o FILE.lightgrid");
  if (file.header.parts != std::array{LightGrid::kAcross, LightGrid::kDown})
    throw InputError(
        name +
        ": has other parts of the sky than 32 x 16; learn it again with frame-render --learn-lights -o FILE.lightgrid");
  auto grid = std::make_unique<LightGrid>(float(file.header.edge), frame.environment);
  std::vector<std::uint64_t> keys;
  std::vector<LightGrid::Cell> cells;
  for (const LightgridCell& from : file.cells) {
    keys.push_back(LightGrid::key_of({from.place, from.facing}));
    LightGrid::Cell& cell = cells.emplace_back();
    cell.sky = from.sky, cell.suns = from.suns;
    std::ranges::copy(from.end, cell.end.begin());
  }
  grid->set(std::move(keys), std::move(cells));
  tool.stats().count("light_cells", double(grid->size()));
  return grid;
}

}  // namespace tempolux::tools
