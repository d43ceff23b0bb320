#include "lib/core/unpack.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "formats/error.h"
#include "lib/core/child_process.h"
#include "lib/core/module_folders.h"

namespace tempolux {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class Number>
void append(std::vector<unsigned char>& to, Number number) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(&number);
  to.insert(to.end(), bytes, bytes + sizeof number);
}

std::vector<unsigned char> request_for(const std::vector<PackedPiece>& pieces) {
  std::vector<unsigned char> request;
  append(request, kUnpackVersion);
  for (const PackedPiece& piece : pieces) {
    append(request, std::uint32_t(piece.packer));
    append(request, std::uint32_t(piece.settings.size()));
    for (const std::uint32_t setting : piece.settings) append(request, setting);
    append(request, std::uint64_t(piece.bytes.size()));
    append(request, piece.unpacked_bytes);
    request.insert(request.end(), piece.bytes.begin(), piece.bytes.end());
  }
  return request;
}

ChildLimits limits_for(const std::vector<PackedPiece>& pieces) {
  ChildLimits limits;
  limits.output_bytes = 0;
  std::uint64_t largest = 0;
  for (const PackedPiece& piece : pieces) {
    limits.output_bytes += piece.unpacked_bytes;
    largest = std::max(largest, 2 * piece.bytes.size() + 20 * piece.unpacked_bytes);
  }
  limits.memory_bytes = memory_that_fits((256ull << 20) + largest);
  limits.processor_s = int(std::min<std::uint64_t>(20 + limits.output_bytes / 1'000'000, 3600));
  limits.wall_s = 60 + 5 * limits.processor_s;
  return limits;
}

/// The piece on which the child was working when it had printed this many bytes.
const PackedPiece& piece_at(const std::vector<PackedPiece>& pieces, std::uint64_t printed) {
  for (const PackedPiece& piece : pieces) {
    if (printed < piece.unpacked_bytes) return piece;
    printed -= piece.unpacked_bytes;
  }
  return pieces.back();
}

}  // namespace

std::vector<unsigned char> unpack(const std::vector<PackedPiece>& pieces) {
  if (pieces.empty()) return {};
  const std::string name = "tempolux-decode";
  const std::string program = installed_file(name, pieces.front().place + ": unpacking");
  const ChildLimits limits = limits_for(pieces);
  ChildResult result = run_child(program, {}, request_for(pieces), limits);
  const PackedPiece& piece = piece_at(pieces, result.output.size());
  if (result.trouble.empty() && result.output.size() < limits.output_bytes) result.trouble = "printed too few bytes";
  if (!result.trouble.empty()) throw InputError(piece.place + ": " + name + " " + result.trouble + "; " + piece.remedy);
  return std::move(result.output);
}

}  // namespace tempolux
