#include "lib/core/json_file.h"

#include <filesystem>
#include <fstream>

#include "formats/error.h"
#include "lib/core/json.h"

namespace tempolux {

using Json = nlohmann::ordered_json;

Json read_json(const std::string& path) {
  constexpr std::uintmax_t kMostBytes = 256u << 20;
  constexpr int kMostLevels = 32;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be read; is the name right?");
  std::error_code not_regular;  // a pipe has no size
  if (const auto size = std::filesystem::file_size(path, not_regular); !not_regular && size > kMostBytes)
    throw InputError(path + ": more than 256 MiB of JSON; this is no file of ours");
  const auto limit_depth = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > kMostLevels) throw InputError(path + ": nested deeper than 32 levels; this is no file of ours");
    return true;
  };
  try {
    return Json::parse(file, limit_depth);
  } catch (const Json::parse_error& error) {
    throw InputError(path + ": byte " + std::to_string(error.byte) + ": not JSON; make it anew");
  } catch (const Json::out_of_range&) {
    throw InputError(path + ": a number is too large for 64 bits of floating point");
  } catch (const std::ios_base::failure&) {  // a folder can be opened, and fails at its first byte
    throw InputError(path + ": cannot be read; is it a folder?");
  }
}

}  // namespace tempolux
