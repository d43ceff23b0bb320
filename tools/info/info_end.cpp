// tools/info/info_end.cpp -- tempolux-info: whether the end of a file is there.
#include <algorithm>
#include <string>
#include <string_view>

#include "formats/container.h"
#include "formats/error.h"
#include "lib/core/json.h"
#include "lib/core/json_file.h"
#include "lib/image/byte_file.h"
#include "lib/image/exr_end.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {
namespace {

std::string last_bytes(const std::string& path, std::size_t most) {
  const ByteFile file(path);
  std::string bytes(std::size_t(std::min<std::uint64_t>(most, file.size())), '\0');
  file.read_at(file.size() - bytes.size(), bytes.data(), bytes.size());
  return bytes;
}

[[noreturn]] void fail(const std::string& path, const char* what) {
  throw InputError(path + ": the file is cut off: it has no " + what + "; write it again");
}

}  // namespace

void check_container_end(const std::string& path, std::size_t totals) {
  constexpr std::size_t kChainSize = 4;
  if (!last_bytes(path, formats::kMarkSize + totals + kChainSize).starts_with(formats::kEndMark))
    fail(path, "end block");
}

void check_png_end(const std::string& path) {
  constexpr std::string_view kEnd("IEND\xae\x42\x60\x82", 8);
  if (!last_bytes(path, kEnd.size()).ends_with(kEnd)) fail(path, "IEND");
}

void check_json_end(const std::string& path) { read_json(path); }

}  // namespace tempolux::tools
