#include "lib/image/cryptomatte.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <set>

#include "lib/image/channel_groups.h"
#include "lib/image/object_names.h"

namespace tempolux {
namespace {

constexpr std::string_view kAttributes = "cryptomatte/";

std::string hex(std::uint32_t bits) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x", bits);
  return text;
}

/// count / total, rounded down.
float share_of(std::uint32_t count, std::uint32_t total) {
  const float share = float(double(count) / total);
  return double(share) * total > count ? std::nextafter(share, 0.0f) : share;
}

/// A JSON string. The text has no control characters.
std::string quoted(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json += '\\';
    json += c;
  }
  return json + '"';
}

/// Number of channels LAYERnn.COMPONENT.
std::size_t channels_of(const Image& image, const std::string& layer) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return std::size_t(std::ranges::count_if(image.channels, [&](const Channel& channel) {
    const std::string_view name = channel.name;
    return name.size() > layer.size() + 3 && name.starts_with(layer) && is_digit(name[layer.size()]) &&
           is_digit(name[layer.size() + 1]) && name[layer.size() + 2] == '.';
  }));
}

}  // namespace

std::uint32_t murmur_hash(std::string_view bytes) {
  const auto scrambled = [](std::uint32_t block) { return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u; };
  std::uint32_t hash = 0;
  std::size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4) {
    std::uint32_t block;
    std::memcpy(&block, bytes.data() + i, 4);
    hash = std::rotl(hash ^ scrambled(block), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t rest = 0;
  for (std::size_t b = 0; i + b < bytes.size(); ++b) rest |= std::uint32_t(std::uint8_t(bytes[i + b])) << (8 * b);
  hash ^= scrambled(rest);  // 0 without a rest
  hash ^= std::uint32_t(bytes.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

std::uint32_t matte_bits(std::string_view name) {
  const std::uint32_t hash = murmur_hash(name), exponent = hash >> 23 & 255;
  return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

std::vector<std::string> matte_names(const std::vector<std::string>& names, const std::string& kind) {
  std::vector<std::string> made;
  std::set<std::string> taken;
  for (const std::string& given : names) {
    const std::string number = std::to_string(made.size());
    std::string name = given.empty() ? kind + " " + number : without_controls(given);
    while (!taken.insert(name).second) name += "#" + number;
    made.push_back(std::move(name));
  }
  return made;
}

MatteChannels::MatteChannels(const char* layer, const std::vector<std::string>& names, Image& image)
    : layer_(layer), names_(names), pixels_(image.pixel_count()) {
  for (const std::string& name : names) bits_.push_back(matte_bits(name));
  for (std::size_t rank = 0; rank < kMatteRanks; ++rank) {
    const std::string begin = layer_ + "0" + std::to_string(rank / 2) + ".";
    hash_planes_.push_back(image.add(begin + (rank % 2 ? "B" : "R")).values.data());
    shares_.push_back(image.add(begin + (rank % 2 ? "A" : "G")).values.data());
  }
}

void MatteChannels::set(std::size_t pixel, std::span<MatteCount> counts, std::uint32_t total) {
  std::ranges::sort(counts, [](const MatteCount& a, const MatteCount& b) {
    return a.samples != b.samples ? a.samples > b.samples : a.number < b.number;
  });
  for (std::size_t rank = 0; rank < std::min(kMatteRanks, counts.size()); ++rank) {
    hash_planes_[rank][pixel] = std::bit_cast<float>(bits_.at(counts[rank].number));
    shares_[rank][pixel] = share_of(counts[rank].samples, total);
  }
}

void MatteChannels::describe(Image& image) const {
  std::set<std::uint32_t> shown;
  for (const float* plane : hash_planes_) {
    std::uint32_t last = 0;  // neighbouring pixels mostly show the same
    for (std::size_t p = 0; p < pixels_; ++p)
      if (const auto bits = std::bit_cast<std::uint32_t>(plane[p]); bits != last) shown.insert(last = bits);
  }
  std::map<std::string, std::uint32_t> manifest;
  for (std::size_t n = 0; n < names_.size(); ++n)
    if (shown.contains(bits_[n])) manifest[names_[n]] = bits_[n];
  std::string json;
  for (const auto& [name, bits] : manifest) json += (json.empty() ? "" : ",") + quoted(name) + ":\"" + hex(bits) + "\"";
  const std::string begin = std::string(kAttributes) + hex(matte_bits(layer_)).substr(0, 7);
  image.text[begin + "/name"] = layer_;
  image.text[begin + "/hash"] = "MurmurHash3_32";
  image.text[begin + "/conversion"] = "uint32_to_float32";
  image.text[begin + "/manifest"] = "{" + json + "}";
}

bool has_mattes(const Image& image) { return std::ranges::any_of(image.channels, is_matte, &Channel::name); }

std::vector<MatteLayer> matte_layers_in(const Image& image) {
  std::vector<MatteLayer> layers;
  for (const auto& [attribute, value] : image.text) {
    if (!attribute.starts_with(kAttributes) || !attribute.ends_with("/name")) continue;
    const auto manifest = image.text.find(attribute.substr(0, attribute.size() - 4) + "manifest");
    layers.push_back(
        {value, manifest == image.text.end() ? "" : manifest->second, (channels_of(image, value) + 1) / 2});
  }
  return layers;
}

bool describes_missing_mattes(const Image& image, std::string_view attribute) {
  if (!attribute.starts_with(kAttributes)) return false;
  const auto layer = image.text.find(std::string(attribute.substr(0, attribute.rfind('/'))) + "/name");
  return layer != image.text.end() && channels_of(image, layer->second) == 0;
}

}  // namespace tempolux
