#include "lib/scene/base64.h"

#include <cstdint>

namespace tempolux::gltf {

std::optional<std::vector<unsigned char>> base64_bytes(std::string_view text) {
  std::vector<unsigned char> bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t group = 0, bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0) return std::nullopt;
    group = (group << 6 | std::uint32_t(digit)) & 0xffffffu;
    if ((bits += 6) >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<unsigned char>(group >> bits & 0xffu));
    }
  }
  return bytes;
}

}  // namespace tempolux::gltf
