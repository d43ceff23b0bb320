// lib/image/object_names.h -- what the objects of a frame are called: its attribute (formats/frames/frames.md 3).
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

/// Writes the attribute: one line "ID NAME" for each of `ids` that has a name. `names` is indexed by id. Control
/// characters become blanks. Ids without a name, or with an empty one, are left out; without any line the attribute
/// is not written.
void set_object_names(Image& image, const std::set<std::uint32_t>& ids, const std::vector<std::string>& names);

/// What set_object_names() wrote. Lines of another form are left out: the attribute may be another program's.
ObjectNames object_names_in(const Image& image);

/// The object's name in quotes, as "Sofa" for messages; `object 17` if id 17 has no name.
std::string object_in_words(std::uint32_t id, const ObjectNames& names);

}  // namespace tempolux
