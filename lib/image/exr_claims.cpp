#include "lib/image/exr_claims.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <utility>

#include "formats/error.h"

namespace tempolux {
namespace {

constexpr std::int32_t kLargestSide = 65536;
constexpr std::size_t kMaxChannels = 1024, kMaxParts = 256;
constexpr std::uint64_t kFreeDisplayBytes = 256ull << 20;
constexpr std::uint32_t kTiledFlag = 0x200, kLongNamesFlag = 0x400, kDeepFlag = 0x800, kMultipartFlag = 0x1000;

/// A compression. Deflate expands a byte to at most 1032 bytes, run lengths to 64. Pxr24 drops a quarter before
/// deflate. Piz: 410 (a run of 256 16-bit values in 10 bits). B44: 11. Both DWA: 64 times deflate (one coefficient for
/// 8x8 pixels).
struct CompressionFacts {
  std::int32_t lines;       ///< per chunk
  std::uint64_t expansion;  ///< largest number of bytes of samples from one byte of the file
};
/// The index is the compression's number in the file.
constexpr std::array<CompressionFacts, 10> kCompressions{
    {{1, 1}, {1, 64}, {1, 1032}, {16, 1032}, {32, 410}, {16, 1376}, {32, 11}, {32, 11}, {32, 66048}, {256, 66048}}};

class HeaderReader {
 public:
  explicit HeaderReader(const ByteFile& file) : file_(file), buffered_(file) {}

  [[noreturn]] void fail(const std::string& what) const { fail_at(position_, what); }
  [[noreturn]] void fail_at(std::uint64_t at, const std::string& what) const {
    throw InputError(file_.path() + ": byte " + std::to_string(at) + ": " + what);
  }
  std::uint64_t position() const { return position_; }
  std::uint64_t left() const { return file_.size() - position_; }

  void bytes(void* to, std::size_t count) {
    if (count > left()) fail("the file ends inside the header; write it again");
    buffered_.read_at(position_, to, count);
    position_ += count;
  }
  template <class T>
  T number() {
    T value;
    bytes(&value, sizeof value);
    return value;
  }
  std::string name(const char* of) {
    std::string text;
    for (char c; (c = number<char>()) != 0;) {
      text += c;
      if (text.size() > 255) fail(std::string("name of ") + of + " longer than 255 bytes; the header is damaged");
    }
    return text;
  }
  void skip_to(std::uint64_t position) { position_ = position; }

 private:
  const ByteFile& file_;
  BufferedFile buffered_;
  std::uint64_t position_ = 0;
};

PixelWindow read_window(HeaderReader& in) {
  PixelWindow window;
  window.x0 = in.number<std::int32_t>();
  window.y0 = in.number<std::int32_t>();
  window.x1 = in.number<std::int32_t>();
  window.y1 = in.number<std::int32_t>();
  return window;
}

std::vector<ExrClaims::ClaimedChannel> read_channels(HeaderReader& in) {
  std::vector<ExrClaims::ClaimedChannel> channels;
  for (std::string name; !(name = in.name("a channel")).empty();) {
    ExrClaims::ClaimedChannel channel;
    channel.name = name;
    channel.type = in.number<std::int32_t>();
    in.number<std::int32_t>();  // pLinear and three reserved bytes
    channel.x_sampling = in.number<std::int32_t>();
    channel.y_sampling = in.number<std::int32_t>();
    channels.push_back(channel);
    if (channels.size() > kMaxChannels) in.fail("more than 1024 channels; the header is damaged");
  }
  return channels;
}

/// Bytes of a value of this type; 0 if they vary. OpenEXR reads this many bytes whatever size the attribute claims. If
/// the claim were wrong, it would read the remaining header from another position than this reader.
std::int32_t size_of_type(std::string_view type) {
  constexpr std::pair<std::string_view, std::int32_t> kSizes[] = {{"box2f", 16},
                                                                  {"box2i", 16},
                                                                  {"chromaticities", 32},
                                                                  {"compression", 1},
                                                                  {"deepImageState", 1},
                                                                  {"double", 8},
                                                                  {"envmap", 1},
                                                                  {"float", 4},
                                                                  {"int", 4},
                                                                  {"keycode", 28},
                                                                  {"lineOrder", 1},
                                                                  {"m33d", 72},
                                                                  {"m33f", 36},
                                                                  {"m44d", 128},
                                                                  {"m44f", 64},
                                                                  {"rational", 8},
                                                                  {"tiledesc", 9},
                                                                  {"timecode", 8},
                                                                  {"v2d", 16},
                                                                  {"v2f", 8},
                                                                  {"v2i", 8},
                                                                  {"v3d", 24},
                                                                  {"v3f", 12},
                                                                  {"v3i", 12}};
  const auto found = std::ranges::find(kSizes, type, &std::pair<std::string_view, std::int32_t>::first);
  return found == std::end(kSizes) ? 0 : found->second;
}

/// Checks that a preview has 4 bytes for each of its pixels.
void check_preview(HeaderReader& in, std::int32_t size) {
  const std::uint64_t width = in.number<std::uint32_t>(), height = in.number<std::uint32_t>();
  if (width > 65536 || height > 65536 || 8 + 4 * width * height != std::uint64_t(size))
    in.fail("a preview of " + std::to_string(width) + " x " + std::to_string(height) + " pixels in " +
            std::to_string(size) + " bytes; the header is damaged");
}

/// Reads one part's attributes up to the empty name that ends them. False for an empty header, which ends the parts.
bool read_part(HeaderReader& in, ExrClaims& part, std::uint64_t& chunk_count) {
  bool any = false;
  for (std::string name; !(name = in.name("an attribute")).empty();) {
    any = true;
    const std::string type = in.name("a type");
    const auto size = in.number<std::int32_t>();
    const std::uint64_t start = in.position();
    if (size < 0 || std::uint64_t(size) > in.left())
      in.fail("attribute " + one_line(name) + " claims " + std::to_string(size) + " bytes, the file has " +
              std::to_string(in.left()) + "; it is truncated or damaged");
    const std::uint64_t end = start + std::uint64_t(size);
    if (const std::int32_t right = size_of_type(type); right != 0 && size != right)
      in.fail("attribute " + one_line(name) + " claims " + std::to_string(size) + " bytes, its type has " +
              std::to_string(right) + "; the header is damaged");
    if (type == "preview") check_preview(in, size);
    if (name == "dataWindow" && type == "box2i") part.data = read_window(in);
    if (name == "displayWindow" && type == "box2i") part.display = read_window(in);
    if (type == "chlist") {
      std::vector<ExrClaims::ClaimedChannel> channels = read_channels(in);
      if (in.position() < end)
        in.fail_at(start, "attribute " + one_line(name) + " is shorter than it says; the header is damaged");
      if (name == "channels") part.channels = std::move(channels);
    }
    if (name == "compression" && type == "compression") part.compression = in.number<std::uint8_t>();
    if (name == "chunkCount" && type == "int") chunk_count = std::uint64_t(in.number<std::uint32_t>());
    if (name == "tiles" && type == "tiledesc") {
      part.tile_width = in.number<std::uint32_t>();
      part.tile_height = in.number<std::uint32_t>();
    }
    if (name == "type" && type == "string" && size <= 16) {
      std::string kind(std::size_t(size), ' ');
      in.bytes(kind.data(), kind.size());
      part.deep = kind.starts_with("deep");
    }
    if (in.position() > end)
      in.fail_at(start, "attribute " + one_line(name) + " is longer than it says; the header is damaged");
    in.skip_to(end);
  }
  return any;
}

void check_window(const HeaderReader& in, const PixelWindow& window, const char* name, std::uint64_t max_pixels) {
  constexpr std::int32_t limit = 1 << 30;
  const bool sane = std::abs(std::int64_t(window.x0)) < limit && std::abs(std::int64_t(window.y0)) < limit &&
                    window.width() > 0 && window.height() > 0;
  if (!sane) in.fail(std::string(name) + " absent, empty or out of range; the header is damaged");
  const std::string size = std::to_string(window.width()) + " x " + std::to_string(window.height());
  if (window.width() > kLargestSide || window.height() > kLargestSide)
    in.fail(std::string(name) + " of " + size + " pixels; at most 65536 a side are read");
  if (std::uint64_t(window.width() * window.height()) > max_pixels)
    in.fail(std::string(name) + " of " + size + " pixels is over the limit of " + std::to_string(max_pixels) +
            "; raise the limit if that is the image's size");
}

/// Checks windows and chunks of a part. All parts are checked, since OpenEXR allocates offset tables for all.
void check_part(const HeaderReader& in, const ExrClaims& part, std::uint64_t chunk_count, std::uint64_t file_size,
                std::uint64_t max_pixels) {
  check_window(in, part.data, "dataWindow", max_pixels);
  check_window(in, part.display, "displayWindow", max_pixels);
  if (part.channels.empty()) in.fail("no channels; there is nothing to read");
  if (part.compression < 0 || std::size_t(part.compression) >= kCompressions.size())
    in.fail("compression absent or unknown; the header is damaged or the file too new");
  if (part.tile_width > 1u << 30 || part.tile_height > 1u << 30) in.fail("tile size out of range");
  const auto up = [](std::int64_t a, std::int64_t b) { return std::uint64_t((a + b - 1) / b); };
  const std::uint64_t chunks = part.tile_width > 0 && part.tile_height > 0
                                   ? up(part.data.width(), part.tile_width) * up(part.data.height(), part.tile_height)
                                   : up(part.data.height(), part.lines_per_chunk());
  // A chunk has 8 bytes in the offset table and a head of 8 bytes.
  if (std::max(chunks, chunk_count) > file_size / 16)
    in.fail("claims " + std::to_string(std::max(chunks, chunk_count)) + " chunks in " + std::to_string(file_size) +
            " bytes; the file is truncated or damaged");
}

void check_samples(const HeaderReader& in, const ExrClaims& part, std::uint64_t file_size) {
  if (part.deep) in.fail("deep pixels; flatten the image first");
  std::uint64_t bytes_per_pixel = 0;
  for (const auto& channel : part.channels) {
    if (channel.type < 0 || channel.type > 2) in.fail("channel " + one_line(channel.name) + " has an unknown type");
    if (channel.x_sampling != 1 || channel.y_sampling != 1)
      in.fail("channel " + one_line(channel.name) + " is subsampled; write it with one sample for each pixel");
    bytes_per_pixel += channel.type == 1 ? 2 : 4;
  }
  const std::uint64_t bytes = bytes_per_pixel * std::uint64_t(part.data.width() * part.data.height());
  if (bytes / kCompressions[std::size_t(part.compression)].expansion > file_size)
    in.fail("claims " + std::to_string(bytes) + " bytes of samples, more than the file's " + std::to_string(file_size) +
            " can hold; it is truncated or damaged");
  // Pixels of the display window outside the data window are not in the file. Memory for them is limited to 256 MiB, or
  // to what deflate could expand the file to.
  const std::uint64_t shown = bytes_per_pixel * std::uint64_t(part.display.width() * part.display.height());
  if (shown > std::max(kFreeDisplayBytes, 1032 * file_size))
    in.fail("displayWindow claims " + std::to_string(shown) + " bytes of samples around a data window of " +
            std::to_string(bytes) + "; crop the display window");
}

}  // namespace

std::int32_t ExrClaims::lines_per_chunk() const { return kCompressions[std::size_t(compression)].lines; }

ExrClaims read_exr_claims(const ByteFile& file, std::uint64_t max_pixels) {
  HeaderReader in(file);
  if (file.size() < 8 || in.number<std::uint32_t>() != 20000630u)
    in.fail_at(0, "not an OpenEXR file; frames are .exr files as in formats/frames/frames.md");
  const auto version = in.number<std::uint32_t>();
  if ((version & 0xff) != 2 || (version & ~(0xffu | kTiledFlag | kLongNamesFlag | kDeepFlag | kMultipartFlag)))
    in.fail_at(4, "OpenEXR version " + std::to_string(version) + "; version 2 is read");

  ExrClaims first;
  for (std::size_t index = 0;; ++index) {
    ExrClaims part;
    part.multipart = version & kMultipartFlag;
    std::uint64_t chunk_count = 0;
    if (!read_part(in, part, chunk_count)) {
      if (index == 0) in.fail("the header is empty");
      break;
    }
    check_part(in, part, chunk_count, file.size(), max_pixels);
    if (index == 0) {
      if (!part.multipart && (version & kDeepFlag)) part.deep = true;
      check_samples(in, part, file.size());
      first = part;
    }
    if (!part.multipart) {
      first.header_bytes = in.position();
      break;
    }
    if (index + 1 == kMaxParts) in.fail("more than 256 parts");
  }
  return first;
}

}  // namespace tempolux
