#include "lib/image/exr_end.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "formats/error.h"
#include "lib/image/byte_file.h"
#include "lib/image/exr_claims.h"
#include "lib/image/exr_io.h"

namespace tempolux {

void check_exr_end(const std::string& path) {
  const ByteFile file(path);
  const ExrClaims claims = read_exr_claims(file, ExrReadOptions{}.max_pixels);
  if (claims.multipart || claims.tile_width > 0) {
    load_exr(path, {.allow_nan = true});
    return;
  }
  const std::int64_t lines = claims.lines_per_chunk(), chunks = (claims.data.height() + lines - 1) / lines;
  std::vector<std::uint64_t> offsets(static_cast<std::size_t>(chunks));
  file.read_at(claims.header_bytes, offsets.data(), 8 * offsets.size());
  const auto [first, last] = std::ranges::minmax(offsets);
  if (first == 0) throw InputError(path + ": offset table: lines are missing; the writer did not finish, run it again");
  std::int32_t head[2];  // line, bytes
  file.read_at(last, head, sizeof head);
  const std::uint64_t end = last + sizeof head + std::uint64_t(std::max(head[1], 0));
  if (end > file.size())
    throw InputError(path + ": byte " + std::to_string(file.size()) + ": the file is cut off, " + std::to_string(end) +
                     " bytes are promised; write it again");
}

}  // namespace tempolux
