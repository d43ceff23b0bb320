// modules/decode_draco.cpp -- decodes KHR_draco_mesh_compression with libdraco.
#include <draco/compression/decode.h>

#include <cstring>
#include <memory>

#include "modules/decode.h"

namespace tempolux {
namespace {

/// The part of the output that is not written yet.
struct Rest {
  std::span<unsigned char> bytes;
  /// Reserves room for `count` numbers of `size` bytes; nullptr if too little room remains.
  unsigned char* take(std::uint64_t count, std::uint64_t size) {
    if (size == 0 || count > bytes.size() / size) return nullptr;
    unsigned char* room = bytes.data();
    bytes = bytes.subspan(std::size_t(count * size));
    return room;
  }
};

template <class Index>
void put_indices(const draco::Mesh& mesh, unsigned char* to) {
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (int corner = 0; corner < 3; ++corner, to += sizeof(Index)) {
      const auto index = Index(mesh.face(f)[std::size_t(corner)].value());
      std::memcpy(to, &index, sizeof index);
    }
}

std::string put_indices(const draco::Mesh& mesh, std::uint32_t index_bytes, std::uint64_t count, Rest& rest) {
  if (3 * std::uint64_t(mesh.num_faces()) != count)
    return "finds " + std::to_string(mesh.num_faces()) + " triangles where the accessor of the indices has " +
           std::to_string(count) + " indices";
  // Indices must fit their type: the largest index is the number of points minus one.
  if (index_bytes < 4 && std::uint64_t(mesh.num_points()) > 1ull << (8 * index_bytes))
    return "finds more vertices than indices of " + std::to_string(index_bytes) + " bytes can name";
  unsigned char* to = rest.take(count, index_bytes);
  if (!to) return "got sizes that do not fit each other";
  if (index_bytes == 1) put_indices<std::uint8_t>(mesh, to);
  if (index_bytes == 2) put_indices<std::uint16_t>(mesh, to);
  if (index_bytes == 4) put_indices<std::uint32_t>(mesh, to);
  return "";
}

template <class Number>
bool put_values(const draco::PointAttribute& attribute, std::uint32_t points, std::uint32_t components, Rest& rest) {
  unsigned char* to = rest.take(std::uint64_t(points) * components, sizeof(Number));
  if (!to) return false;
  std::vector<Number> values(components);
  for (draco::PointIndex p(0); p < points; ++p) {
    const draco::AttributeValueIndex value = attribute.mapped_index(p);
    if (value.value() >= attribute.size() ||
        !attribute.ConvertValue<Number>(value, std::int8_t(components), values.data()))
      return false;
    std::memcpy(to, values.data(), sizeof(Number) * components);
    to += sizeof(Number) * components;
  }
  return true;
}

/// Writes one attribute. `wanted`: its id in the Draco data, glTF's component type, numbers per vertex.
std::string put_attribute(const draco::Mesh& mesh, std::span<const std::uint32_t> wanted, Rest& rest) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(wanted[0]);
  const std::string name = "attribute " + std::to_string(wanted[0]);
  if (!attribute) return "finds no " + name;
  const std::uint32_t points = mesh.num_points(), components = wanted[2];
  if (components != attribute->num_components())
    return "finds " + std::to_string(attribute->num_components()) + " numbers per vertex in " + name +
           " where the accessor has " + std::to_string(components);
  bool put = false;
  switch (wanted[1]) {
    case 5120: put = put_values<std::int8_t>(*attribute, points, components, rest); break;
    case 5121: put = put_values<std::uint8_t>(*attribute, points, components, rest); break;
    case 5122: put = put_values<std::int16_t>(*attribute, points, components, rest); break;
    case 5123: put = put_values<std::uint16_t>(*attribute, points, components, rest); break;
    case 5125: put = put_values<std::uint32_t>(*attribute, points, components, rest); break;
    case 5126: put = put_values<float>(*attribute, points, components, rest); break;
    default: break;
  }
  return put ? "" : "cannot turn the values of " + name + " into the accessor's type";
}

}  // namespace

std::string decode_draco(std::span<const std::uint32_t> settings, std::span<const unsigned char> packed,
                         std::span<unsigned char> unpacked) {
  if (settings.size() < 4 || settings.size() != 4 + 3 * std::size_t(settings[3]))
    return "got a request that is no request for Draco";
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  draco::Decoder decoder;
  draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return "cannot decode the Draco data: " + decoded.status().error_msg_string();
  const draco::Mesh& mesh = *decoded.value();
  if (mesh.num_points() != settings[2])
    return "finds " + std::to_string(mesh.num_points()) + " vertices where the accessors have " +
           std::to_string(settings[2]);
  Rest rest{unpacked};
  std::string trouble = settings[0] != 0 ? put_indices(mesh, settings[0], settings[1], rest) : "";
  for (std::size_t a = 4; a < settings.size() && trouble.empty(); a += 3)
    trouble = put_attribute(mesh, settings.subspan(a, 3), rest);
  if (trouble.empty() && !rest.bytes.empty()) trouble = "got sizes that do not fit each other";
  return trouble;
}

}  // namespace tempolux
