// modules/tempolux-decode.cpp -- a child program that decodes Draco, meshoptimizer, WebP or AVIF data.
// lib/core/unpack.cpp starts it under limits of memory and time; lib/core/unpack.h describes its input and output.
// Users do not call it.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "lib/core/unpack.h"
#include "modules/decode.h"
#include "modules/guard.h"

namespace {

using namespace tempolux;

/// Reads exactly `count` bytes from standard input; false if it ends before.
bool read_all(void* to, std::size_t count) {
  auto* at = static_cast<unsigned char*>(to);
  while (count > 0) {
    const ssize_t got = ::read(STDIN_FILENO, at, std::min<std::size_t>(count, 1u << 30));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    count -= std::size_t(got);
  }
  return true;
}

bool write_all(const unsigned char* from, std::size_t count) {
  while (count > 0) {
    const ssize_t put = ::write(STDOUT_FILENO, from, std::min<std::size_t>(count, 1u << 30));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    from += put;
    count -= std::size_t(put);
  }
  return true;
}

struct Piece {
  Packer packer{};
  std::vector<std::uint32_t> settings;
  std::vector<unsigned char> packed, unpacked;
};

/// Reads a piece; false at the end of the input. A piece that is cut off counts as the end: the caller has died.
bool read_piece(Piece& piece) {
  std::uint32_t head[2];
  std::uint64_t sizes[2];
  if (!read_all(head, sizeof head)) return false;
  piece.packer = Packer(head[0]);
  piece.settings.resize(head[1]);
  if (!read_all(piece.settings.data(), 4 * piece.settings.size()) || !read_all(sizes, sizeof sizes)) return false;
  piece.packed.resize(sizes[0]);
  if (!read_all(piece.packed.data(), piece.packed.size())) return false;
  piece.unpacked.assign(sizes[1], 0);
  return true;
}

std::string decode(Piece& piece) {
  switch (piece.packer) {
    case Packer::draco: return decode_draco(piece.settings, piece.packed, piece.unpacked);
    case Packer::meshopt: return decode_meshopt(piece.settings, piece.packed, piece.unpacked);
    case Packer::webp: return decode_webp(piece.settings, piece.packed, piece.unpacked);
    case Packer::avif: return decode_avif(piece.settings, piece.packed, piece.unpacked);
  }
  return "does not know what packed this data";
}

int run() {
  if (const std::string trouble = guard_process(); !trouble.empty()) {
    std::fprintf(stderr, "%s\n", trouble.c_str());
    return 2;
  }
  std::uint32_t version = 0;
  if (!read_all(&version, sizeof version) || version != kUnpackVersion) {
    std::fputs("is of another version than the tool that started it: install both together\n", stderr);
    return 2;
  }
  for (Piece piece; read_piece(piece); piece = {}) {
    const std::string trouble = decode(piece);
    if (!trouble.empty()) {
      std::fprintf(stderr, "%s\n", trouble.c_str());
      return 2;
    }
    if (!write_all(piece.unpacked.data(), piece.unpacked.size())) return 3;
  }
  return 0;
}

}  // namespace

int main() {
  try {
    return run();
  } catch (const std::bad_alloc&) {
    std::fputs("needs more memory than it may take for data of this size\n", stderr);
  } catch (const std::exception& error) { std::fprintf(stderr, "cannot decode it: %s\n", error.what()); }
  return 2;
}
