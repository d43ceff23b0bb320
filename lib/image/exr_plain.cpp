#include "lib/image/exr_plain.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

namespace tempolux {
namespace {

static_assert(std::endian::native == std::endian::little, "EXR files are little-endian, and so is what is copied here");

constexpr std::size_t kChunkHead = 8;  // int32 line, int32 bytes

/// The samples of one channel in a line of the file, and their destination in the image.
struct Stretch {
  std::size_t at = 0;  ///< byte offset in the line
  char* to = nullptr;  ///< destination of the first line
};

/// The places of the image's channels in a line of the file. Empty if one of the image's channels is stored as half
/// floats, or if two channels have the same name. `line_bytes` receives the bytes of a line: all channels of the file.
std::vector<Stretch> stretches(const ExrClaims& claims, Image& image, std::size_t& line_bytes) {
  std::vector<const ExrClaims::ClaimedChannel*> claimed;
  for (const ExrClaims::ClaimedChannel& channel : claims.channels) claimed.push_back(&channel);
  // Samples are in the order of names, whatever the header's order.
  std::ranges::sort(claimed, {}, &ExrClaims::ClaimedChannel::name);
  const auto width = std::size_t(image.width);
  std::vector<Stretch> found;
  line_bytes = 0;
  for (const ExrClaims::ClaimedChannel* channel : claimed) {
    constexpr std::int32_t kHalf = 1;
    if (Channel* to = image.find(channel->name)) {
      if (channel->type == kHalf) return {};
      found.push_back({line_bytes, to->ids.empty() ? reinterpret_cast<char*>(to->values.data())
                                                   : reinterpret_cast<char*>(to->ids.data())});
    }
    line_bytes += (channel->type == kHalf ? 2 : 4) * width;
  }
  // If two channels have the same name, this reader gives up, and OpenEXR reads the file.
  return found.size() == image.channels.size() ? found : std::vector<Stretch>();
}

}  // namespace

bool read_plain_lines(const ByteFile& file, const ExrClaims& claims, Image& image, int first, int last) {
  constexpr std::int32_t kNone = 0;
  if (claims.compression != kNone || claims.tile_width != 0 || claims.multipart || claims.deep ||
      claims.header_bytes == 0)
    return false;
  std::size_t line_bytes = 0;
  const std::vector<Stretch> wanted = stretches(claims, image, line_bytes);
  if (wanted.empty() || line_bytes > 0x7fffffff) return false;

  std::vector<std::uint64_t> offsets(std::size_t(last - first));
  const std::uint64_t table = claims.header_bytes + 8 * std::uint64_t(first);
  if (table + 8 * offsets.size() > file.size()) return false;
  file.read_at(table, offsets.data(), 8 * offsets.size());
  std::vector<char> line(kChunkHead + line_bytes);
  const std::size_t row_bytes = 4 * std::size_t(image.width);
  for (int y = first; y < last; ++y) {
    const std::uint64_t offset = offsets[std::size_t(y - first)];
    if (offset < claims.header_bytes || offset > file.size() || line.size() > file.size() - offset) return false;
    file.read_at(offset, line.data(), line.size());
    std::int32_t head[2];
    std::memcpy(head, line.data(), sizeof head);
    if (std::int64_t(head[0]) != std::int64_t(claims.data.y0) + y || head[1] != std::int32_t(line_bytes)) return false;
    for (const Stretch& stretch : wanted)
      std::memcpy(stretch.to + std::size_t(y) * row_bytes, line.data() + kChunkHead + stretch.at, row_bytes);
  }
  return true;
}

std::string plain_lines(const Image& image, int first, int count) {
  std::vector<const Channel*> channels;
  for (const Channel& channel : image.channels) channels.push_back(&channel);
  std::ranges::sort(channels, {}, &Channel::name);
  const std::size_t row_bytes = 4 * std::size_t(image.width), line_bytes = row_bytes * channels.size();
  std::string bytes(std::size_t(count) * (kChunkHead + line_bytes), '\0');
  char* to = bytes.data();
  for (int y = first; y < first + count; ++y) {
    const std::int32_t head[2] = {y, std::int32_t(line_bytes)};
    std::memcpy(to, head, sizeof head);
    to += kChunkHead;
    for (const Channel* channel : channels) {
      const void* samples =
          channel->ids.empty() ? static_cast<const void*>(channel->values.data()) : channel->ids.data();
      std::memcpy(to, static_cast<const char*>(samples) + std::size_t(y) * row_bytes, row_bytes);
      to += row_bytes;
    }
  }
  return bytes;
}

}  // namespace tempolux
