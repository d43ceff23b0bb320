// lib/core/json.h -- the only place that includes the JSON library; headers that only name its types include
// json_file.h instead.
#pragma once

#include <nlohmann/json.hpp>
