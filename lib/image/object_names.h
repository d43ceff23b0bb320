// lib/image/object_names.h -- the attribute with the names of a frame's objects (formats/frames/frames.md 3).
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

inline constexpr std::string_view kObjectNames = "tempolux:objects";

/// Names of objects by id.object.
using ObjectNames = std::map<std::uint32_t, std::string>;

/// The name with blanks in place of control characters.
std::string without_controls(std::string name);

/// Writes the attribute: a line "ID NAME" for each of `ids` that has a name. `names` is indexed by id; an empty name is
/// none. Control characters become blanks. Without any line the attribute is not written.
void set_object_names(Image& image, const std::set<std::uint32_t>& ids, const std::vector<std::string>& names);

/// Reads what set_object_names() wrote. Lines of another form are ignored, since another program may have written the
/// attribute.
ObjectNames object_names_in(const Image& image);

/// The object's name in quotes, for messages: "Sofa"; `object 17` if id 17 has no name.
std::string object_in_words(std::uint32_t id, const ObjectNames& names);

}  // namespace tempolux
