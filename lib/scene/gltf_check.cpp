// lib/scene/gltf_check.cpp -- checks and reads accessors.
#include "lib/scene/gltf_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tempolux::gltf {
namespace {

constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR: return 1;
    case TINYGLTF_TYPE_VEC2: return 2;
    case TINYGLTF_TYPE_VEC3: return 3;
    case TINYGLTF_TYPE_VEC4: return 4;
    case TINYGLTF_TYPE_MAT2: return 4;
    case TINYGLTF_TYPE_MAT3: return 9;
    case TINYGLTF_TYPE_MAT4: return 16;
    default: return 0;
  }
}

/// offset + stride (count - 1) + size, or kNoLimit if the sum does not fit 64 bits.
std::uint64_t bytes_needed(std::uint64_t offset, std::uint64_t stride, std::uint64_t count, std::uint64_t size) {
  if (count == 0) return 0;
  std::uint64_t span = 0, end = 0;
  if (__builtin_mul_overflow(stride, count - 1, &span) || __builtin_add_overflow(span, size, &span) ||
      __builtin_add_overflow(span, offset, &end))
    return kNoLimit;
  return end;
}

void check_view(const Import& import, std::size_t index) {
  const tinygltf::BufferView& view = import.model.bufferViews[index];
  const std::string place = place_of("bufferViews", index, view.name);
  if (view.buffer < 0 || std::size_t(view.buffer) >= import.model.buffers.size())
    import.fail(place, "buffer " + std::to_string(view.buffer) + " does not exist");
  const std::uint64_t length = import.model.buffers[std::size_t(view.buffer)].data.size();
  if (bytes_needed(view.byteOffset, 1, view.byteLength, 1) > length)
    import.fail(place, "bytes " + std::to_string(view.byteOffset) + " + " + std::to_string(view.byteLength) +
                           " lie outside buffer " + std::to_string(view.buffer) + " of " + std::to_string(length) +
                           " bytes");
}

/// `count` elements of `size` bytes, `stride` apart from `offset` on, in a view.
struct ViewPart {
  int view;
  std::uint64_t offset, stride, count, size;
};

void check_inside_view(const Import& import, const std::string& place, const ViewPart& part) {
  const auto [view_index, offset, stride, count, size] = part;
  if (view_index < 0 || std::size_t(view_index) >= import.model.bufferViews.size())
    import.fail(place, "bufferView " + std::to_string(view_index) + " does not exist");
  const std::uint64_t length = import.model.bufferViews[std::size_t(view_index)].byteLength;
  if (bytes_needed(offset, stride, count, size) > length)
    import.fail(place, std::to_string(count) + " elements of " + std::to_string(size) + " bytes from byte " +
                           std::to_string(offset) + " do not fit bufferView " + std::to_string(view_index) + " of " +
                           std::to_string(length) + " bytes");
}

std::uint64_t stride_of(const tinygltf::Model& model, const tinygltf::Accessor& accessor, std::uint64_t size) {
  const std::uint64_t stride = model.bufferViews[std::size_t(accessor.bufferView)].byteStride;
  return stride != 0 ? stride : size;
}

void check_sparse(const Import& import, const tinygltf::Accessor& accessor, const std::string& place,
                  std::uint64_t size) {
  const auto& sparse = accessor.sparse;
  if (sparse.count < 0 || std::uint64_t(sparse.count) > accessor.count || sparse.indices.byteOffset < 0 ||
      sparse.values.byteOffset < 0)
    import.fail(place, "sparse part is larger than the accessor or has a negative offset");
  const int index_type = sparse.indices.componentType;
  const int index_size = component_bytes(index_type);
  if (index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    import.fail(place, "sparse indices must be unsigned integers");
  const std::uint64_t count = std::uint64_t(sparse.count);
  check_inside_view(import, place + ".sparse.indices",
                    {sparse.indices.bufferView, std::uint64_t(sparse.indices.byteOffset), std::uint64_t(index_size),
                     count, std::uint64_t(index_size)});
  check_inside_view(import, place + ".sparse.values",
                    {sparse.values.bufferView, std::uint64_t(sparse.values.byteOffset), size, count, size});
}

void check_accessor(const Import& import, std::size_t index) {
  const tinygltf::Accessor& accessor = import.model.accessors[index];
  const std::string place = place_of("accessors", index, accessor.name);
  const int component = component_bytes(accessor.componentType), components = component_count(accessor.type);
  if (component == 0)
    import.fail(place, "componentType " + std::to_string(accessor.componentType) + " is not one of glTF's");
  if (components == 0) import.fail(place, "type is not one of glTF's");
  if (accessor.count == 0) import.fail(place, "count is 0");
  const std::uint64_t size = std::uint64_t(component * components);
  if (accessor.bufferView != -1) {
    if (accessor.bufferView < 0 || std::size_t(accessor.bufferView) >= import.model.bufferViews.size())
      import.fail(place, "bufferView " + std::to_string(accessor.bufferView) + " does not exist");
    check_inside_view(
        import, place,
        {accessor.bufferView, accessor.byteOffset, stride_of(import.model, accessor, size), accessor.count, size});
  }
  if (accessor.sparse.isSparse) check_sparse(import, accessor, place, size);
}

/// The bytes of an accessor, element by element.
struct Elements {
  const unsigned char* first = nullptr;
  std::uint64_t count = 0, stride = 0;
  int component_type = 0, components = 0;
  bool normalized = false;
  std::vector<unsigned char> own{};  ///< owned bytes of a sparse accessor, or of one without a view (zeros)
};

std::uint64_t read_index(const unsigned char* bytes, int component_type) {
  if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *bytes;
  if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
    std::uint16_t value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }
  std::uint32_t value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

const unsigned char* view_bytes(const tinygltf::Model& model, int view_index, std::uint64_t offset) {
  const tinygltf::BufferView& view = model.bufferViews[std::size_t(view_index)];
  return model.buffers[std::size_t(view.buffer)].data.data() + view.byteOffset + offset;
}

/// Copies a sparse accessor densely and applies its replacements.
void make_dense(Import& import, const tinygltf::Accessor& accessor, const std::string& place, Elements& elements) {
  const std::uint64_t size = std::uint64_t(component_bytes(accessor.componentType) * elements.components);
  std::uint64_t bytes = 0;
  if (__builtin_mul_overflow(size, elements.count, &bytes)) bytes = kNoLimit;
  import.take_memory(bytes, place);
  elements.own.assign(bytes, 0);
  if (elements.first)
    for (std::uint64_t i = 0; i < elements.count; ++i)
      std::memcpy(&elements.own[i * size], elements.first + i * elements.stride, size);
  if (accessor.sparse.isSparse) {
    const auto& sparse = accessor.sparse;
    if (sparse.count == 0) import.mend(place, "a sparse part of no elements (sparse.count 0) replaces nothing", 1);
    const int index_type = sparse.indices.componentType;
    const unsigned char* indices =
        view_bytes(import.model, sparse.indices.bufferView, std::uint64_t(sparse.indices.byteOffset));
    const unsigned char* values =
        view_bytes(import.model, sparse.values.bufferView, std::uint64_t(sparse.values.byteOffset));
    for (std::uint64_t i = 0; i < std::uint64_t(sparse.count); ++i) {
      const std::uint64_t target = read_index(indices + i * std::uint64_t(component_bytes(index_type)), index_type);
      if (target >= elements.count)
        import.fail(place, "sparse index " + std::to_string(target) + " is beyond the accessor's " +
                               std::to_string(elements.count) + " elements");
      std::memcpy(&elements.own[target * size], values + i * size, size);
    }
  }
  elements.first = elements.own.data();
  elements.stride = size;
}

Elements open_accessor(Import& import, int index, int components, const std::string& place) {
  if (index < 0 || std::size_t(index) >= import.model.accessors.size())
    import.fail(place, "accessor " + std::to_string(index) + " does not exist");
  const tinygltf::Accessor& accessor = import.model.accessors[std::size_t(index)];
  Elements elements;
  elements.count = accessor.count;
  elements.component_type = accessor.componentType;
  elements.components = component_count(accessor.type);
  elements.normalized = accessor.normalized;
  const int type = components == 1 ? TINYGLTF_TYPE_SCALAR : components == 16 ? TINYGLTF_TYPE_MAT4 : components;
  if (accessor.type != type)  // VEC2 .. VEC4 have the values 2 .. 4
    import.fail(place, "accessor " + std::to_string(index) + " has another type than is needed here (" +
                           std::to_string(components) + " numbers per element)");
  if (accessor.bufferView != -1) {
    const std::uint64_t size = std::uint64_t(component_bytes(accessor.componentType) * components);
    elements.first = view_bytes(import.model, accessor.bufferView, accessor.byteOffset);
    elements.stride = stride_of(import.model, accessor, size);
  }
  if (accessor.sparse.isSparse || !elements.first) make_dense(import, accessor, place, elements);
  return elements;
}

/// Calls put(element, component, value) for all numbers. If the accessor is normalised, integers are multiplied by
/// `scale`; `scale` is 0 for floats, which stay as they are.
template <class Stored, class Put>
void convert(const Elements& elements, double scale, Put put) {
  for (std::uint64_t i = 0; i < elements.count; ++i) {
    const unsigned char* bytes = elements.first + i * elements.stride;
    for (int c = 0; c < elements.components; ++c) {
      Stored stored;
      std::memcpy(&stored, bytes + std::size_t(c) * sizeof(Stored), sizeof(Stored));
      put(i, c, elements.normalized && scale > 0 ? std::max(double(stored) * scale, -1.0) : double(stored));
    }
  }
}

/// Reads components of any type as numbers and calls put(element, component, value). 32-bit integers are refused: glTF
/// allows them for indices only. Returns the elements with NaN or infinity, each once, ascending; the caller must
/// replace their values.
template <class Put>
std::vector<std::uint32_t> read_all(Import& import, const Elements& elements, const std::string& place, int index,
                                    Put put_value) {
  std::vector<std::uint32_t> unusable;
  const auto put = [&](std::uint64_t i, int c, double value) {
    if (!std::isfinite(value) && (unusable.empty() || unusable.back() != i)) unusable.push_back(std::uint32_t(i));
    put_value(i, c, value);
  };
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT: convert<float>(elements, 0, put); break;
    case TINYGLTF_COMPONENT_TYPE_BYTE: convert<std::int8_t>(elements, 1 / 127.0, put); break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: convert<std::uint8_t>(elements, 1 / 255.0, put); break;
    case TINYGLTF_COMPONENT_TYPE_SHORT: convert<std::int16_t>(elements, 1 / 32767.0, put); break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: convert<std::uint16_t>(elements, 1 / 65535.0, put); break;
    default: import.fail(place, "accessor " + std::to_string(index) + " has 32-bit integers where numbers are needed");
  }
  return unusable;
}

/// Elements as vectors; at(vector, c) is component c. Unusable elements become 0.
template <class Vector, class At>
std::vector<Vector> read_vectors(Import& import, int accessor, const std::string& place,
                                 std::vector<std::uint32_t>& unusable, const At& at) {
  const Elements elements = open_accessor(import, accessor, sizeof(Vector) / sizeof(float), place);
  import.take_memory(elements.count * sizeof(Vector), place);
  std::vector<Vector> values(elements.count);
  unusable = read_all(import, elements, place, accessor,
                      [&](std::uint64_t i, int c, double v) { at(values[i], c) = float(v); });
  for (const std::uint32_t i : unusable) values[i] = {};
  return values;
}

void refuse(const Import& import, int index, const std::string& place, const std::vector<std::uint32_t>& unusable) {
  if (!unusable.empty())
    import.fail(place,
                "accessor " + std::to_string(index) + " holds NaN or infinity; export the mesh again without it");
}

}  // namespace

void Import::mend(const std::string& place, const std::string& what, std::size_t count) {
  Mended& sort = mended[what];
  if (sort.places++ == 0) sort.first_place = place;
  sort.count += count;
}

void Import::take_memory(std::uint64_t bytes, const std::string& place) {
  if (bytes > geometry_budget)
    fail(place, "asks for far more memory than a file of this size can hold (counts or shared accessors are wrong)");
  geometry_budget -= bytes;
}

void check_accessors(const Import& import) {
  for (std::size_t i = 0; i < import.model.bufferViews.size(); ++i) check_view(import, i);
  for (std::size_t i = 0; i < import.model.accessors.size(); ++i) check_accessor(import, i);
}

std::vector<Vec3> read_vec3(Import& import, int accessor, const std::string& place,
                            std::vector<std::uint32_t>& unusable) {
  return read_vectors<Vec3>(import, accessor, place, unusable, [](Vec3& v, int c) -> float& { return v[c]; });
}

std::vector<Vec2> read_vec2(Import& import, int accessor, const std::string& place,
                            std::vector<std::uint32_t>& unusable) {
  return read_vectors<Vec2>(import, accessor, place, unusable,
                            [](Vec2& v, int c) -> float& { return c == 0 ? v.x : v.y; });
}

std::vector<Vec3> read_vec3(Import& import, int accessor, const std::string& place) {
  std::vector<std::uint32_t> unusable;
  std::vector<Vec3> values = read_vec3(import, accessor, place, unusable);
  refuse(import, accessor, place, unusable);
  return values;
}

std::vector<std::uint32_t> read_indices(Import& import, int accessor, const std::string& place) {
  const Elements elements = open_accessor(import, accessor, 1, place);
  const int type = elements.component_type;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    import.fail(place, "indices (accessor " + std::to_string(accessor) + ") must be unsigned integers");
  import.take_memory(elements.count * sizeof(std::uint32_t), place);
  std::vector<std::uint32_t> values(elements.count);
  for (std::uint64_t i = 0; i < elements.count; ++i)
    values[i] = std::uint32_t(read_index(elements.first + i * elements.stride, type));
  return values;
}

std::vector<double> read_numbers(Import& import, int accessor, int components, const std::string& place,
                                 std::vector<std::uint32_t>& unusable) {
  const Elements elements = open_accessor(import, accessor, components, place);
  import.take_memory(elements.count * std::uint64_t(components) * sizeof(double), place);
  std::vector<double> values(elements.count * std::uint64_t(components));
  const auto element = [&](std::uint64_t i) { return values.begin() + std::ptrdiff_t(i) * components; };
  unusable = read_all(import, elements, place, accessor, [&](std::uint64_t i, int c, double v) { element(i)[c] = v; });
  for (const std::uint32_t i : unusable) std::fill_n(element(i), components, 0.0);
  return values;
}

std::vector<double> read_numbers(Import& import, int accessor, int components, const std::string& place) {
  std::vector<std::uint32_t> unusable;
  std::vector<double> values = read_numbers(import, accessor, components, place, unusable);
  refuse(import, accessor, place, unusable);
  return values;
}

}  // namespace tempolux::gltf
