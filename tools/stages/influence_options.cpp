#include "tools/stages/influence_options.h"

#include <CLI/CLI.hpp>

#include "formats/error.h"
#include "tools/common/option_words.h"

namespace tempolux::tools {
void influence_options(Tool& tool, InfluenceThresholds& thresholds) {
  CLI::App& app = tool.app();
  app.add_option("--influence-low", thresholds.low,
                 "up to this influence of the movers, as a share of the static irradiance, indirect light is read from "
                 "static records, updated by dynamic photons")
      ->capture_default_str()
      ->check(number_between(0));
  app.add_option("--influence-high", thresholds.high,
                 "from this influence on indirect light is gathered anew; blended in between")
      ->capture_default_str()
      ->check(number_above(0));
}

void check_influence(const InfluenceThresholds& thresholds) {
  if (!(thresholds.low < thresholds.high)) throw InputError("--influence-low must be below --influence-high");
}

}  // namespace tempolux::tools
