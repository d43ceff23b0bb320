// tests/support/packers.h -- packs data as exporters do, with the libraries that tempolux-decode uses to unpack.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tempolux::test {

/// One attribute of a Draco mesh: `components` floats for each vertex.
struct DracoAttribute {
  enum class Kind { position, normal, uv } kind = Kind::position;
  int components = 3;
  std::vector<float> values;
};

/// A triangle mesh packed by Draco; attribute i has the id i. With `bits` 0 nothing is quantised, and vertices and
/// triangles keep their order (sequential method). Otherwise Draco's usual method (edge breaker) is used, which
/// changes the order.
std::string draco_bytes(const std::vector<std::uint32_t>& indices, const std::vector<DracoAttribute>& attributes,
                        int bits = 0);

/// Elements of `size` bytes, packed in meshopt's mode ATTRIBUTES.
std::string meshopt_attributes(const std::string& elements, std::size_t size);
/// Indices packed in mode INDICES, which keeps them, and in mode TRIANGLES, which rotates the corners of a triangle.
std::string meshopt_indices(const std::vector<std::uint32_t>& indices);
std::string meshopt_triangles(const std::vector<std::uint32_t>& indices, std::size_t vertices);
/// Unit vectors x, y, z, w as 4 bytes each, in the form that filter OCTAHEDRAL expects; not packed yet.
std::string octahedral_elements(const std::vector<float>& vectors);

/// A lossless WebP of RGBA or RGB pixels, row 0 on top.
std::string webp_bytes(int width, int height, int channels, const std::vector<std::uint8_t>& pixels);

/// How an AVIF holds its picture.
struct AvifForm {
  bool as_rgb = true;          ///< green, blue and red as coded, without loss; false: brightness and colour (BT.601)
  int depth = 8;               ///< bits of a channel in the file
  bool premultiplied = false;  ///< the file's colours are multiplied by alpha
  int quarter_turns = -1;      ///< viewers shall turn the picture; -1: the file does not speak of it
  bool mirrored = false;       ///< viewers shall mirror it
  int frames = 1;              ///< above 1: an animation
};
/// An AVIF of RGBA or RGB pixels, row 0 on top, with the finest quantisation.
std::string avif_bytes(int width, int height, int channels, const std::vector<std::uint8_t>& pixels,
                       const AvifForm& form = {});

}  // namespace tempolux::test
