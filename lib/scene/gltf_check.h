// lib/scene/gltf_check.h -- accessors of a glTF file, checked before they are read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"
#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

/// Checks in 64-bit arithmetic that every bufferView lies inside its buffer, and every accessor with its sparse parts
/// inside its view. Must be called before the functions below. Throws InputError that names the first violation.
void check_accessors(const Import& import);

/// Elements of an accessor as floats; integers are normalised if the accessor asks for it (KHR_mesh_quantization).
/// `place` is the place in the file that names the accessor, for messages. Throws InputError if the accessor does not
/// exist or has another type, or if a number is not finite.
std::vector<Vec3> read_vec3(Import& import, int accessor, const std::string& place);
/// The same, but an element with NaN or infinity becomes 0, and its index goes to `unusable` (ascending).
std::vector<Vec3> read_vec3(Import& import, int accessor, const std::string& place,
                            std::vector<std::uint32_t>& unusable);
std::vector<Vec2> read_vec2(Import& import, int accessor, const std::string& place,
                            std::vector<std::uint32_t>& unusable);
std::vector<double> read_numbers(Import& import, int accessor, int components, const std::string& place,
                                 std::vector<std::uint32_t>& unusable);
/// Reads unsigned 8, 16 or 32-bit integers, not normalised.
std::vector<std::uint32_t> read_indices(Import& import, int accessor, const std::string& place);
/// All numbers of an accessor in one array: `components` per element (1, 3, 4, or 16 for a matrix by columns).
std::vector<double> read_numbers(Import& import, int accessor, int components, const std::string& place);

}  // namespace tempolux::gltf
