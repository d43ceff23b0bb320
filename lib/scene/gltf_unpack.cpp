#include "lib/scene/gltf_unpack.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "formats/error.h"
#include "lib/core/unpack.h"
#include "lib/scene/base64.h"
#include "lib/scene/gltf_extensions.h"

namespace tempolux::gltf {
namespace {

/// Largest ratio of unpacked to packed size. Draco may need less than a bit for a triangle of a regular grid, which has
/// at least 12 bytes when unpacked; meshopt packs at most 64 to 1. Files may always unpack to kSmall bytes.
constexpr std::uint64_t kMostGrowth = 1000, kSmall = 64u << 20;

/// Collects the packed pieces of a document, and assigns places to their unpacked bytes.
class Unpacking {
 public:
  Unpacking(Json& document, const std::string& path, const GltfOptions& options, Gated& gated)
      : document_(document), path_(path), options_(options), gated_(gated) {}

  /// Adds a bufferView that is packed by meshopt.
  void add_view(std::size_t index, const char* name) {
    Json& view = document_["bufferViews"][index];
    const std::string place = place_of("bufferViews", index) + ".extensions." + name;
    Json packed = view["extensions"][name];
    check_meshopt(packed, place, path_);
    PackedPiece piece = piece_of(Packer::meshopt, place, name);
    const std::uint64_t count = packed["count"].get<std::uint64_t>(),
                        stride = packed["byteStride"].get<std::uint64_t>();
    if (count == 0 || count > 0xffffffffu || stride == 0 || stride > 256)
      fail(place, "count and byteStride must be at least 1, byteStride at most 256");
    piece.settings = {std::uint32_t(mode_of(packed, place)), std::uint32_t(filter_of(packed, place)),
                      std::uint32_t(count), std::uint32_t(stride)};
    piece.unpacked_bytes = count * stride;
    piece.bytes = bytes_of(packed["buffer"].get<std::size_t>(), packed.value("byteOffset", std::uint64_t{0}),
                           packed["byteLength"].get<std::uint64_t>(), place);
    place_view(view, piece.unpacked_bytes);
    add(std::move(piece));
  }

  /// Adds a primitive whose accessors are packed by Draco.
  void add_primitive(std::size_t mesh, std::size_t number) {
    Json& primitive = document_["meshes"][mesh]["primitives"][number];
    const std::string place =
        place_of("meshes", mesh) + ".primitives[" + std::to_string(number) + "].extensions." + kDraco;
    Json packed = primitive["extensions"][kDraco];
    check_draco(packed, place, path_);
    if (primitive.value("mode", 4) != 4) fail(place, "packs something else than a list of triangles");
    if (!primitive.contains("indices")) fail(place, "packs a primitive without indices");
    const std::size_t source = packed["bufferView"].get<std::size_t>();
    std::vector<Part> parts{{primitive["indices"].get<std::size_t>(), kIndices}};
    for (const auto& [name, id] : packed["attributes"].items()) {
      if (!primitive["attributes"].contains(name))
        fail(place + ".attributes." + name.substr(0, 60), "is no attribute of the primitive");
      parts.push_back({primitive["attributes"][name].get<std::size_t>(), id.get<std::int64_t>()});
    }
    add_parts(source, parts, place);
  }

  /// Unpacks all pieces and appends them as one buffer.
  void finish() {
    if (pieces_.empty()) return;
    const std::uint64_t limit = std::min(options_.max_file_bytes, kMostGrowth * packed_bytes_ + kSmall);
    if (unpacked_bytes_ > limit)
      throw InputError(path_ + ": unpacked: " + std::to_string(unpacked_bytes_) + " bytes from " +
                       std::to_string(packed_bytes_) + " packed ones, more than can be right");
    gated_.unpacked = unpack(pieces_);
    gated_.byte_count += unpacked_bytes_;
    gated_.buffers.push_back({"", 0, unpacked_bytes_});
    document_["buffers"].push_back({{"byteLength", unpacked_bytes_}, {"uri", buffer_name(gated_.buffers.size() - 1)}});
  }

 private:
  static constexpr const char* kDraco = "KHR_draco_mesh_compression";
  static constexpr std::int64_t kIndices = -1;

  /// An accessor and the attribute of the Draco data that it receives.
  struct Part {
    std::size_t accessor;
    std::int64_t id;
  };

  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    throw InputError(path_ + ": " + place + ": " + what);
  }

  PackedPiece piece_of(Packer packer, const std::string& place, const char* extension) const {
    PackedPiece piece;
    piece.packer = packer;
    piece.place = path_ + ": " + place;
    piece.remedy = remedy_of(extension);
    return piece;
  }

  void add(PackedPiece piece) {
    packed_bytes_ += piece.bytes.size();
    unpacked_bytes_ += piece.unpacked_bytes;
    if (unpacked_bytes_ > options_.max_file_bytes)
      fail("unpacked", "more than " + std::to_string(options_.max_file_bytes) + " bytes");
    pieces_.push_back(std::move(piece));
  }

  /// Points a bufferView to `bytes` unpacked bytes, which start `behind` bytes after the pieces that were added.
  void place_view(Json& view, std::uint64_t bytes, std::uint64_t behind = 0) const {
    view["buffer"] = gated_.buffers.size();
    view["byteOffset"] = unpacked_bytes_ + behind;
    view["byteLength"] = bytes;
  }

  void add_parts(std::size_t source, const std::vector<Part>& parts, const std::string& place) {
    PackedPiece piece = piece_of(Packer::draco, place, kDraco);
    piece.bytes = bytes_of_view(source, place);
    std::vector<std::uint64_t> offsets;
    for (const Part& part : parts) {
      offsets.push_back(piece.unpacked_bytes);
      add_part(part, piece, place);
    }
    piece.settings[3] = std::uint32_t(parts.size() - 1);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      Json& accessor = document_["accessors"][parts[i].accessor];
      const std::uint64_t end = i + 1 < parts.size() ? offsets[i + 1] : piece.unpacked_bytes;
      Json view = Json::object();
      place_view(view, end - offsets[i], offsets[i]);
      accessor["bufferView"] = document_["bufferViews"].size();
      accessor["byteOffset"] = 0;
      document_["bufferViews"].push_back(std::move(view));
    }
    add(std::move(piece));
  }

  /// Appends the decoding settings and the size of one accessor to the piece. The accessor of the indices must come
  /// first.
  void add_part(const Part& part, PackedPiece& piece, const std::string& place) const {
    const Json& accessors = array_of(document_, "accessors");
    if (part.accessor >= accessors.size()) fail(place, "accessor " + std::to_string(part.accessor) + " does not exist");
    const Json& accessor = accessors[part.accessor];
    const std::string accessor_place = place_of("accessors", part.accessor);
    const std::uint64_t count = accessor["count"].get<std::uint64_t>();
    const int type = accessor["componentType"].get<int>();
    const std::uint32_t size = std::uint32_t(component_bytes(type)),
                        components = components_of(accessor["type"].get<std::string>());
    if (size == 0 || components == 0) fail(accessor_place, "has a type that Draco does not pack");
    if (count == 0 || count > 0xffffffffu) fail(accessor_place, "count " + std::to_string(count) + " cannot be right");
    piece.unpacked_bytes += count * size * components;
    if (part.id == kIndices) {
      if (components != 1 || (type != 5121 && type != 5123 && type != 5125))
        fail(accessor_place, "indices must be unsigned integers");
      piece.settings = {size, std::uint32_t(count), 0, 0};
      return;
    }
    if (piece.settings[2] != 0 && piece.settings[2] != count) fail(place, "its accessors have different counts");
    piece.settings[2] = std::uint32_t(count);
    for (const std::uint32_t setting : {std::uint32_t(part.id), std::uint32_t(type), components})
      piece.settings.push_back(setting);
  }

  static std::uint32_t components_of(std::string_view type) {
    constexpr std::array<std::string_view, 5> types{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    const auto found = std::find(types.begin(), types.end(), type);
    return found == types.end() ? 0 : std::uint32_t(found - types.begin());
  }

  MeshoptMode mode_of(const Json& packed, const std::string& place) const {
    const std::string mode = packed["mode"].get<std::string>();
    if (mode == "ATTRIBUTES") return MeshoptMode::attributes;
    if (mode == "TRIANGLES") return MeshoptMode::triangles;
    if (mode == "INDICES") return MeshoptMode::indices;
    fail(place + ".mode", "is not ATTRIBUTES, TRIANGLES or INDICES");
  }

  MeshoptFilter filter_of(const Json& packed, const std::string& place) const {
    const std::string filter = packed.value("filter", "NONE");
    if (filter == "NONE") return MeshoptFilter::none;
    if (filter == "OCTAHEDRAL") return MeshoptFilter::octahedral;
    if (filter == "QUATERNION") return MeshoptFilter::quaternion;
    if (filter == "EXPONENTIAL") return MeshoptFilter::exponential;
    fail(place + ".filter",
         "\"" + filter.substr(0, 40) + "\" is not supported; " + remedy_of("KHR_meshopt_compression"));
  }

  std::vector<unsigned char> bytes_of_view(std::size_t index, const std::string& place) const {
    const Json& views = array_of(document_, "bufferViews");
    if (index >= views.size()) fail(place, "bufferView " + std::to_string(index) + " does not exist");
    const Json& view = views[index];
    return bytes_of(view["buffer"].get<std::size_t>(), view.value("byteOffset", std::uint64_t{0}),
                    view["byteLength"].get<std::uint64_t>(), place);
  }

  /// Bytes of a part of a buffer of the file.
  std::vector<unsigned char> bytes_of(std::size_t buffer, std::uint64_t offset, std::uint64_t length,
                                      const std::string& place) const {
    if (buffer >= gated_.buffers.size()) fail(place, "buffer " + std::to_string(buffer) + " does not exist");
    const std::uint64_t whole = document_["buffers"][buffer]["byteLength"].get<std::uint64_t>();
    if (length == 0 || offset > whole || length > whole - offset)
      fail(place, "bytes " + std::to_string(offset) + " + " + std::to_string(length) + " lie outside buffer " +
                      std::to_string(buffer) + " of " + std::to_string(whole) + " bytes");
    const ByteRange& range = gated_.buffers[buffer];
    if (is_stand_in(document_["buffers"][buffer])) fail(place, "buffer " + std::to_string(buffer) + " has no bytes");
    if (range.length > 0) return read_range({range.path, range.offset + offset, length});
    const std::string uri = document_["buffers"][buffer]["uri"].get<std::string>();
    const auto bytes = base64_bytes(std::string_view(uri).substr(uri.find(',') + 1));  // the gate has checked the text
    return {bytes->begin() + std::ptrdiff_t(offset), bytes->begin() + std::ptrdiff_t(offset + length)};
  }

  Json& document_;
  const std::string& path_;
  const GltfOptions& options_;
  Gated& gated_;
  std::vector<PackedPiece> pieces_;
  std::uint64_t packed_bytes_ = 0, unpacked_bytes_ = 0;
};

bool takes_out(Json& object, const char* name) {
  const auto extensions = object.find("extensions");
  return extensions != object.end() && extensions->erase(name) > 0;
}

/// Makes the image of an extension the source of textures that have no other.
void use_images_of(const char* name, Json& document, const std::string& path) {
  if (!document.contains("textures")) return;
  for (std::size_t t = 0; t < document["textures"].size(); ++t) {
    Json& texture = document["textures"][t];
    if (!has_extension(texture, name)) continue;
    Json packed = texture["extensions"][name];
    check_image_source(packed, place_of("textures", t) + ".extensions." + name, path);
    if (!texture.contains("source")) texture["source"] = packed["source"];
    takes_out(texture, name);
  }
}

}  // namespace

void unpack_packed(Json& document, const std::string& path, const GltfOptions& options, Gated& gated) {
  Unpacking unpacking(document, path, options, gated);
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    for (std::size_t v = 0; v < array_of(document, "bufferViews").size(); ++v)
      if (view_is_packed_only(document, document["bufferViews"][v], name)) unpacking.add_view(v, name);
  for (std::size_t m = 0; m < array_of(document, "meshes").size(); ++m)
    for (std::size_t p = 0; p < document["meshes"][m]["primitives"].size(); ++p) {
      constexpr const char* name = "KHR_draco_mesh_compression";
      Json& primitive = document["meshes"][m]["primitives"][p];
      if (primitive_is_packed_only(document, primitive, name)) unpacking.add_primitive(m, p);
    }
  for (const char* name : kImageExtensions) use_images_of(name, document, path);
  unpacking.finish();
  if (document.contains("buffers"))  // packed files have buffers without bytes, which tinygltf must not open
    for (Json& buffer : document["buffers"])
      if (is_stand_in(buffer)) buffer = {{"byteLength", 1}, {"uri", "data:application/octet-stream;base64,AA=="}};
}

}  // namespace tempolux::gltf
