// photonmap-split -- divide the light of a .photons or .irradpoints file in two files whose sum is the whole.
//
//     photonmap-split p.irradpoints --low low.irradpoints --high high.irradpoints
//     photon-trace room.glb -o - | photonmap-split - --low low.photons --high high.photons --energy 8
//
// Method: docs/methods/split.md. Formats: formats/photons/photons.md, formats/irradpoints/irradpoints.md.
#include <cmath>

#include "lib/core/formatted.h"
#include "tools/common/cli.h"
#include "tools/stages/split_files.h"

using namespace tempolux;

int main(int argc, char** argv) {
  tools::Tool tool("photonmap-split", "Divide light in two files by brightness: a low and a high part.", argc, argv);
  tools::SplitOptions options;
  tool.file_option("input", options.input, ".photons or .irradpoints file; - for standard input")->required();
  tool.output_option(options.low, "the low part: light of bright cells up to their limit, and all light of other cells",
                     "--low")
      ->required();
  tool.output_option(options.high, "the high part: light of bright cells above their limit", "--high")->required();
  tool.number_option("--energy", options.limit, 0, tools::kNoLimit,
                     "times the mean irradiance, W/m^2, of all cells with light: the irradiance that the low part of a "
                     "cell has at most");
  tool.auto_option("--cell", options.cell, 0, tools::kNoLimit,
                   formatted("edge of a cell, metres; auto: %g mean distances of points, or %g of photons (%zu photons "
                             "per cell on average)",
                             options.spacings_per_cell, std::sqrt(double(kRecordsPerCell)), kRecordsPerCell))
      ->type_name("METRES");
  tool.common_options(0);
  return tool.run([&] {
    tools::split_file(tool, options);
    return tools::exit_ok;
  });
}
