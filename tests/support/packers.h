// tests/support/packers.h -- what exporters do: packs data with the libraries that tempolux-decode unpacks it with.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tempolux::test {

/// One attribute of a Draco mesh: floats, `components` for each vertex.
struct DracoAttribute {
  enum class Kind { position, normal, uv } kind = Kind::position;
  int components = 3;
  std::vector<float> values;
};

/// A triangle mesh packed by Draco; attribute i has the id i. `bits` 0: nothing is quantised and vertices and triangles
/// keep their order (sequential method); else Draco's usual method (edge breaker), which changes the order.
std::string draco_bytes(const std::vector<std::uint32_t>& indices, const std::vector<DracoAttribute>& attributes,
                        int bits = 0);

/// Elements of `size` bytes in meshopt's mode ATTRIBUTES.
std::string meshopt_attributes(const std::string& elements, std::size_t size);
/// Modes INDICES (keeps everything) and TRIANGLES (turns the corners of triangles).
std::string meshopt_indices(const std::vector<std::uint32_t>& indices);
std::string meshopt_triangles(const std::vector<std::uint32_t>& indices, std::size_t vertices);
/// Unit vectors x, y, z, w as 4 bytes each, made ready for filter OCTAHEDRAL; not packed yet.
std::string octahedral_elements(const std::vector<float>& vectors);

/// A lossless WebP of RGBA or RGB pixels, row 0 on top.
std::string webp_bytes(int width, int height, int channels, const std::vector<std::uint8_t>& pixels);

}  // namespace tempolux::test
