#include "lib/points/whole_photons.h"

#include <array>
#include <cstring>
#include <unordered_map>

#include "lib/core/random.h"

namespace tempolux {
namespace {

using formats::Photon;

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

formats::PhotonBlock whole_photons(const PhotonMaps& maps, const std::function<bool(Vec3, const Photon&)>& wanted) {
  std::unordered_map<Photon, int, PhotonHash> gone;
  formats::PhotonBlock whole;
  const auto take = [&](const PhotonView& map, std::size_t i, Vec3 place) {
    Photon photon = map.photons[i];
    photon.position = array_of(place);
    append(map, i, photon, whole);
  };
  for (std::size_t i = 0; i < maps.dynamic.photons.size(); ++i) {
    Photon photon = maps.dynamic.photons[i];
    const Vec3 place = shifted(photon.position, maps.dynamic_shift);
    if (!wanted(place, photon)) continue;
    if (!is_negative(photon)) {
      take(maps.dynamic, i, place);
      continue;
    }
    for (float& flux : photon.flux) flux = 0 - flux;
    ++gone[photon];
  }
  for (std::size_t i = 0; i < maps.fixed.photons.size(); ++i) {
    const Photon& photon = maps.fixed.photons[i];
    const Vec3 place = shifted(photon.position, maps.fixed_shift);
    if (!wanted(place, photon)) continue;
    if (const auto found = gone.find(photon); found != gone.end() && found->second > 0) --found->second;
    else take(maps.fixed, i, place);
  }
  if (whole.directions.size() != whole.photons.size()) whole.directions.clear();
  return whole;
}

}  // namespace tempolux
