// modules/decode_meshopt.cpp -- decodes EXT_meshopt_compression with meshoptimizer. The decoders do not check counts
// and sizes, so this file checks them as the extension demands.
#include <meshoptimizer.h>

#include "lib/core/unpack.h"
#include "modules/decode.h"

namespace tempolux {
namespace {

/// Decodes indices of two or four bytes; triangle indices must form whole triangles.
std::string decode_indices(bool triangles, std::size_t count, std::size_t size, std::span<const unsigned char> packed,
                           std::span<unsigned char> unpacked) {
  if ((size != 2 && size != 4) || (triangles && count % 3 != 0)) return "got sizes that no index data has";
  const int result = triangles
                         ? meshopt_decodeIndexBuffer(unpacked.data(), count, size, packed.data(), packed.size())
                         : meshopt_decodeIndexSequence(unpacked.data(), count, size, packed.data(), packed.size());
  if (result == -1) return "does not know this version of meshopt index data";
  return result == 0 ? "" : "cannot decode the index data: it is damaged";
}

std::string decode_attributes(MeshoptFilter filter, std::size_t count, std::size_t size,
                              std::span<const unsigned char> packed, std::span<unsigned char> unpacked) {
  if (size < 4 || size > 256 || size % 4 != 0) return "got sizes that no attribute data has";
  const int result = meshopt_decodeVertexBuffer(unpacked.data(), count, size, packed.data(), packed.size());
  if (result == -1) return "does not know this version of meshopt attribute data (it knows version 0)";
  if (result != 0) return "cannot decode the attribute data: it is damaged";
  const bool fits = (filter != MeshoptFilter::octahedral || size == 4 || size == 8) &&
                    (filter != MeshoptFilter::quaternion || size == 8);
  if (!fits) return "got an element size that does not fit the filter";
  if (filter == MeshoptFilter::octahedral) meshopt_decodeFilterOct(unpacked.data(), count, size);
  if (filter == MeshoptFilter::quaternion) meshopt_decodeFilterQuat(unpacked.data(), count, size);
  if (filter == MeshoptFilter::exponential) meshopt_decodeFilterExp(unpacked.data(), count, size);
  return "";
}

}  // namespace

std::string decode_meshopt(std::span<const std::uint32_t> settings, std::span<const unsigned char> packed,
                           std::span<unsigned char> unpacked) {
  if (settings.size() != 4) return "got a request that is no request for meshopt";
  const auto mode = MeshoptMode(settings[0]);
  const auto filter = MeshoptFilter(settings[1]);
  const std::size_t count = settings[2], size = settings[3];
  if (unpacked.size() != count * size) return "got a size that does not fit the number of elements";
  if (mode == MeshoptMode::attributes) return decode_attributes(filter, count, size, packed, unpacked);
  return decode_indices(mode == MeshoptMode::triangles, count, size, packed, unpacked);
}

}  // namespace tempolux
