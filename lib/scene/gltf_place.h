// lib/scene/gltf_place.h -- places in a glTF file, and texts from it, for messages (gltf_load.cpp).
#pragma once

#include <cstddef>
#include <string>

namespace tempolux::gltf {

/// Throws InputError "FILE: PLACE: WHAT".
[[noreturn]] void fail(const std::string& file, const std::string& place, const std::string& what);

/// The first line of `text`, cut to `length` bytes, with ? in place of control characters. Messages quote text of files
/// and libraries in this form.
std::string one_line(std::string text, std::size_t length);

/// Bytes of a number of glTF's component type (5120 to 5126); 0 for any other type.
constexpr int component_bytes(int type) {
  return type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : type == 5125 || type == 5126 ? 4 : 0;
}

/// A place in the file: `meshes[3]`, or `meshes[3] "Wall"` if it has a name.
std::string place_of(const char* array, std::size_t index, const std::string& name = {});

}  // namespace tempolux::gltf
