#include "lib/image/object_names.h"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace tempolux {

std::string without_controls(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return name;
}

void set_object_names(Image& image, const std::set<std::uint32_t>& ids, const std::vector<std::string>& names) {
  std::string text;
  for (const std::uint32_t id : ids) {
    if (id >= names.size() || names[id].empty()) continue;
    text += std::to_string(id) + " " + without_controls(names[id]) + "\n";
  }
  if (!text.empty()) image.text[std::string(kObjectNames)] = text;
}

ObjectNames object_names_in(const Image& image) {
  ObjectNames names;
  const auto found = image.text.find(std::string(kObjectNames));
  if (found == image.text.end()) return names;
  std::istringstream lines(found->second);
  for (std::string line; std::getline(lines, line);) {
    std::uint32_t id = 0;
    const char* const end = line.data() + line.size();
    const auto [rest, error] = std::from_chars(line.data(), end, id);
    if (error == std::errc() && end - rest > 1 && *rest == ' ') names[id] = std::string(rest + 1, end);
  }
  return names;
}

std::string object_in_words(std::uint32_t id, const ObjectNames& names) {
  const auto found = names.find(id);
  return found == names.end() ? "object " + std::to_string(id) : "\"" + found->second + "\"";
}

}  // namespace tempolux
