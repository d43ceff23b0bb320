#include "lib/gather/whole_photons.h"

#include <array>
#include <cstring>
#include <unordered_map>

#include "lib/core/random.h"

namespace tempolux {
namespace {

using formats::Photon;

Vec3 placed(const Photon& photon, Vec3d shift) {
  return Vec3(Vec3d{double(photon.position[0]), double(photon.position[1]), double(photon.position[2])} + shift);
}

bool is_negative(const Photon& photon) { return photon.flux[0] < 0 || photon.flux[1] < 0 || photon.flux[2] < 0; }

struct PhotonHash {
  std::size_t operator()(const Photon& photon) const {
    std::array<std::uint64_t, sizeof(Photon) / 8> words;
    std::memcpy(words.data(), &photon, sizeof photon);
    std::uint64_t hash = 0;
    for (const std::uint64_t word : words) hash = mix64(hash ^ word) + 0x9e3779b97f4a7c15ull;
    return hash;
  }
};

}  // namespace

std::vector<Photon> whole_photons(const PhotonMaps& maps, const std::function<bool(Vec3, const Photon&)>& wanted) {
  std::unordered_map<Photon, int, PhotonHash> gone;
  std::vector<Photon> photons;
  const auto take = [&](Photon photon, Vec3 place) {
    photon.position = {place.x, place.y, place.z};
    photons.push_back(photon);
  };
  for (Photon photon : maps.dynamic) {
    const Vec3 place = placed(photon, maps.dynamic_shift);
    if (!wanted(place, photon)) continue;
    if (!is_negative(photon)) {
      take(photon, place);
      continue;
    }
    for (float& flux : photon.flux) flux = 0 - flux;
    ++gone[photon];
  }
  for (const Photon& photon : maps.fixed) {
    const Vec3 place = placed(photon, maps.fixed_shift);
    if (!wanted(place, photon)) continue;
    if (const auto found = gone.find(photon); found != gone.end() && found->second > 0) --found->second;
    else take(photon, place);
  }
  return photons;
}

}  // namespace tempolux
