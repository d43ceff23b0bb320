// tools/common/cli.h -- the only place that includes CLI11, which parses the options of all tools.
#pragma once

#include <CLI/CLI.hpp>
