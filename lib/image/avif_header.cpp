#include "lib/image/avif_header.h"

#include <algorithm>
#include <bitset>
#include <cstdint>
#include <limits>
#include <string_view>

namespace tempolux {
namespace {

using Bytes = std::span<const unsigned char>;
using namespace std::string_view_literals;

/// Reads big-endian numbers one after the other. After a read beyond the end, `ok` is false and all numbers are 0.
struct Reader {
  Bytes rest;
  bool ok = true;

  Bytes bytes(std::uint64_t count) {
    if (count > rest.size()) ok = false, rest = {};
    if (!ok) return {};
    const Bytes taken = rest.first(std::size_t(count));
    rest = rest.subspan(std::size_t(count));
    return taken;
  }
  std::uint64_t number(int byte_count) {
    std::uint64_t value = 0;
    for (const unsigned char byte : bytes(std::uint64_t(byte_count))) value = value << 8 | byte;
    return value;
  }
};

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

struct Box {
  std::string_view type;  ///< four letters
  Bytes content;
};

/// Takes the next box; nullopt at the end and where a box reaches beyond the end.
std::optional<Box> next_box(Reader& reader) {
  const std::uint64_t there = reader.rest.size();
  std::uint64_t size = reader.number(4), head = 8;
  Box box;
  box.type = text_of(reader.bytes(4));
  if (size == 1) size = reader.number(8), head = 16;
  if (size == 0) size = there;  // to the end
  if (!reader.ok || size < head) return std::nullopt;
  box.content = reader.bytes(size - head);
  if (!reader.ok) return std::nullopt;
  return box;
}

/// The content of the first box of this type; without bytes if there is none.
Bytes find_box(Bytes bytes, std::string_view type) {
  Reader reader{bytes};
  while (const std::optional<Box> box = next_box(reader))
    if (box->type == type) return box->content;
  return {};
}

/// The head of a box that has a version and flags.
struct Version {
  std::uint64_t version, flags;
  explicit Version(Reader& reader) : version(reader.number(1)), flags(reader.number(3)) {}
};

/// Numbers of properties, from 1 on; they have 15 bits.
using Properties = std::bitset<1u << 15>;

/// Finds the properties of an item in a box ipma; false if it has none there.
bool properties_of(std::uint64_t item, Bytes associations, Properties& properties) {
  Reader reader{associations};
  const Version head(reader);
  for (std::uint64_t entries = reader.number(4); entries > 0 && reader.ok; --entries) {
    const bool found = reader.number(head.version < 1 ? 2 : 4) == item;
    for (std::uint64_t count = reader.number(1); count > 0; --count) {
      const bool is_long = (head.flags & 1) != 0;
      const std::uint64_t number = reader.number(is_long ? 2 : 1) & (is_long ? 0x7fffu : 0x7fu);
      if (found) properties.set(std::size_t(number));
    }
    if (found) return reader.ok;
  }
  return false;
}

}  // namespace

bool is_media_file(Bytes bytes) { return bytes.size() >= 16 && text_of(bytes.subspan(4, 4)) == "ftyp"sv; }

bool has_brand_of_avif(Bytes bytes) {
  Reader reader{bytes};
  const std::optional<Box> box = next_box(reader);
  if (!box || box->type != "ftyp"sv) return false;
  // The main brand, a version, further brands.
  for (Reader brands{box->content}; brands.ok;)
    if (const std::string_view brand = text_of(brands.bytes(4)); brand == "avif"sv || brand == "avis"sv) return true;
  return false;
}

std::optional<AvifHeader> read_avif_header(Bytes bytes) {
  Bytes meta = find_box(bytes, "meta"sv);
  if (meta.size() < 4) return std::nullopt;
  meta = meta.subspan(4);
  Reader primary{find_box(meta, "pitm"sv)};
  const std::uint64_t item = primary.number(Version(primary).version == 0 ? 2 : 4);
  if (!primary.ok) return std::nullopt;

  const Bytes properties_box = find_box(meta, "iprp"sv);
  Properties properties;
  bool found = false;
  for (Reader reader{properties_box}; !found;) {
    const std::optional<Box> box = next_box(reader);
    if (!box) return std::nullopt;
    if (box->type == "ipma"sv) found = properties_of(item, box->content, properties);
  }

  AvifHeader header;
  Reader reader{find_box(properties_box, "ipco"sv)};
  for (std::size_t number = 1; number < properties.size(); ++number) {
    const std::optional<Box> box = next_box(reader);
    if (!box) break;
    if (!properties.test(number)) continue;
    Reader content{box->content};
    if (box->type == "ispe"sv && header.width == 0) {
      const Version version(content);
      const std::uint64_t width = content.number(4), height = content.number(4);
      constexpr std::uint64_t most = std::numeric_limits<int>::max();
      if (!content.ok || version.version != 0 || std::max(width, height) > most) return std::nullopt;
      header.width = int(width);
      header.height = int(height);
    } else if (box->type == "irot"sv) {
      header.is_transformed |= (content.number(1) & 3) != 0;  // quarters of a turn
    } else if (box->type == "imir"sv || box->type == "clap"sv) {
      header.is_transformed = true;
    }
  }
  if (header.width == 0) return std::nullopt;
  return header;
}

}  // namespace tempolux
