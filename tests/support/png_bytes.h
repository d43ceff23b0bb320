// tests/support/png_bytes.h -- makes PNG files in memory, without a library: one stored block.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/encoded_image.h"
#include "lib/scene/scene.h"

namespace tempolux::test {

inline std::uint32_t png_crc(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= std::uint8_t(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

/// A PNG of 8-bit pixels, row 0 on top, 1 to 4 channels; at most 65535 bytes, including one filter byte per row.
inline std::string png_bytes(int width, int height, int channels, const std::vector<std::uint8_t>& pixels) {
  const auto big = [](std::uint32_t v) {
    return std::string{char(v >> 24), char(v >> 16 & 255), char(v >> 8 & 255), char(v & 255)};
  };
  const auto chunk = [&](const std::string& type, const std::string& data) {
    return big(std::uint32_t(data.size())) + type + data + big(png_crc(type + data));
  };
  std::string rows;
  const std::size_t row = std::size_t(width) * std::size_t(channels);
  for (std::size_t y = 0; y < std::size_t(height); ++y) {
    rows += '\0';
    rows.append(reinterpret_cast<const char*>(pixels.data()) + y * row, row);
  }
  std::uint32_t a = 1, b = 0;  // Adler-32
  for (const char c : rows) {
    a = (a + std::uint8_t(c)) % 65521;
    b = (b + a) % 65521;
  }
  const std::uint32_t n = std::uint32_t(rows.size());
  const std::string stored = std::string("\x78\x01\x01", 3) + char(n & 255) + char(n >> 8 & 255) + char(~n & 255) +
                             char(~n >> 8 & 255) + rows + big(b << 16 | a);
  const char types[] = {0, 0, 4, 2, 6};  // by number of channels
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR", big(std::uint32_t(width)) + big(std::uint32_t(height)) + '\x08' + types[channels] +
                           std::string(3, '\0')) +
         chunk("IDAT", stored) + chunk("IEND", "");
}

inline EncodedImage png_image(int width, int height, int channels, const std::vector<std::uint8_t>& pixels) {
  const std::string bytes = png_bytes(width, height, channels, pixels);
  return {"test.png", {bytes.begin(), bytes.end()}, width, height, "digest"};
}

/// A texture of image number `image`, with untransformed coordinates; without interpolation if `nearest`.
inline Texture texture_of_image(std::uint32_t image = 0, bool nearest = true) {
  Texture texture;
  texture.image = image;
  texture.nearest = nearest;
  return texture;
}

}  // namespace tempolux::test
