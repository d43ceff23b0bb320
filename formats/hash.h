// formats/hash.h -- content hashes (XXH3, 128 bits) of files, scenes and digests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace tempolux {

/// XXH3 of 128 bits over all added bytes. The hash does not depend on the pieces in which they were added.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;

  void add_bytes(const void* data, std::size_t size);
  /// Adds a string and its length, so that "ab","c" differs from "a","bc".
  void add(std::string_view text);
  /// Adds a number, or a plain struct without padding; little-endian, as on every machine that this program supports.
  template <class T>
  requires(std::is_trivially_copyable_v<T> && !std::is_convertible_v<T, std::string_view>) void add(const T& value) {
    add_bytes(&value, sizeof(T));
  }
  /// Adds an array and its length.
  template <class T>
  void add_array(std::span<const T> values) {
    add(std::uint64_t(values.size()));
    add_bytes(values.data(), values.size_bytes());
  }

  /// 32 lower-case hexadecimal digits. More data may be added afterwards.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Hash of one string of bytes.
std::string hash_hex(std::string_view bytes);
/// Hash of several strings, each with its length.
std::string hash_of_texts(std::initializer_list<std::string_view> texts);

}  // namespace tempolux
