#include "formats/identity.h"

#include <array>
#include <stdexcept>

namespace tempolux::formats {
namespace {

struct Concern {
  std::string_view name;
  std::string Identity::* hash;
};
constexpr std::array<Concern, 6> kConcerns{{{"static_geometry", &Identity::static_geometry},
                                            {"moving_geometry", &Identity::moving_geometry},
                                            {"materials", &Identity::materials},
                                            {"lights", &Identity::lights},
                                            {"media", &Identity::media},
                                            {"emission", &Identity::emission}}};

std::string Identity::* hash_of(std::string_view name) {
  for (const Concern& concern : kConcerns)
    if (concern.name == name) return concern.hash;
  throw std::invalid_argument("stale_concerns: no concern is called " + std::string(name));
}

}  // namespace

std::vector<std::string> stale_concerns(const Identity& file, const Identity& scene,
                                        const std::vector<std::string_view>& concerns) {
  std::vector<std::string> stale;
  for (std::string_view name : concerns) {
    const auto hash = hash_of(name);
    const bool comparable = file.known() && scene.known() && !(file.*hash).empty() && !(scene.*hash).empty();
    if (comparable && file.*hash != scene.*hash) stale.emplace_back(name);
  }
  return stale;
}

}  // namespace tempolux::formats
