#include "formats/identity.h"

namespace tempolux::formats {

std::string stale_concerns(const Identity& file, const Identity& scene, std::span<const Concern> concerns) {
  std::string stale;
  for (const auto& [name, hash] : concerns) {
    const bool comparable = file.known() && scene.known() && !(file.*hash).empty() && !(scene.*hash).empty();
    if (comparable && file.*hash != scene.*hash) stale.append(stale.empty() ? "" : ", ").append(name);
  }
  return stale;
}

}  // namespace tempolux::formats
