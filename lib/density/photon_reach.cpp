#include "lib/density/photon_reach.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/density/irradiance_estimate.h"

namespace tempolux {
namespace {

/// Photons to measure at. The share 1/kStray of photons beyond the reach is then known to sqrt(.05 x .95 / 1000) = .7
/// %.
constexpr std::size_t kAsked = 1000;
constexpr std::size_t kStray = 20;  ///< one photon in this many may have its neighbours farther away than the reach

}  // namespace

float photon_reach(const PhotonIndex& index, int neighbours, const std::function<bool(Vec3)>& where) {
  if (index.size() == 0) return 0;
  std::vector<std::size_t> meant;
  for (std::size_t i = 0; where && i < index.size(); ++i)
    if (where(index.position(i))) meant.push_back(i);
  const std::size_t count = meant.empty() ? index.size() : meant.size(),
                    step = std::max<std::size_t>(1, count / kAsked);
  NeighbourList found;
  std::vector<float> distance2;
  for (std::size_t j = 0; j < count; j += step) {
    const std::size_t i = meant.empty() ? j : meant[j];
    // One more, since a photon finds itself.
    index.find_nearest({index.position(i), index.normal(i), INFINITY, kMinCos, kFlattening},
                       std::min(neighbours + 1, kMaxNeighbours), found);
    if (found.count() > 0) distance2.push_back(found.distance2()[found.farthest()]);
  }
  if (distance2.empty()) return index.resolution();
  const auto at = distance2.end() - 1 - std::ptrdiff_t(distance2.size() / kStray);
  std::nth_element(distance2.begin(), at, distance2.end());
  return std::max(std::sqrt(*at), index.resolution());
}

}  // namespace tempolux
