// lib/core/json_file.h -- reads JSON files of this project.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tempolux {

/// Reads the JSON document of a file; members keep the order of the file. Throws InputError "FILE: WHAT; REMEDY" if the
/// file cannot be read, is larger than 256 MiB, is not valid JSON, is nested deeper than 32 levels, or has a number
/// outside the range of a double.
nlohmann::ordered_json read_json(const std::string& path);

}  // namespace tempolux
