// tests/formats/photons_files.h -- small .photons files for the tests of the format.
#pragma once

#include <string>
#include <vector>

#include "formats/photons/photons.h"
#include "tests/formats/files.h"

namespace tempolux::formats::testing {

/// All photons of a map, with the columns and the digest.
struct Contents {
  PhotonHeader header;
  std::vector<PhotonBlock> groups;  ///< one block per group that has photons
  PhotonTotals totals;
  std::vector<GroupFlux> ledger;
  std::string digest;

  std::size_t photon_count() const {
    std::size_t count = 0;
    for (const PhotonBlock& block : groups) count += block.photons.size();
    return count;
  }
};

inline Contents read_all(const std::string& path) {
  PhotonReader reader(path);
  Contents all{reader.header(), {}, {}, {}, {}};
  PhotonBlock block;
  while (reader.read_block(block)) {
    if (all.groups.empty() || all.groups.back().group != block.group) all.groups.push_back({block.group, {}, {}, {}});
    PhotonBlock& group = all.groups.back();
    group.photons.insert(group.photons.end(), block.photons.begin(), block.photons.end());
    group.directions.insert(group.directions.end(), block.directions.begin(), block.directions.end());
    group.albedos.insert(group.albedos.end(), block.albedos.begin(), block.albedos.end());
  }
  all.totals = reader.totals();
  all.ledger = reader.ledger();
  all.digest = reader.digest();
  return all;
}

inline std::string bytes_of(const PhotonHeader& header, const std::vector<PhotonBlock>& blocks,
                            const PhotonTotals& totals = {}, const std::vector<GroupFlux>& ledger = {}) {
  std::string bytes;
  PhotonWriter writer([&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); },
                      header);
  for (const PhotonBlock& block : blocks) writer.write(block);
  writer.finish(totals, ledger);
  return bytes;
}

/// A photon whose every field depends on i.
inline Photon photon(std::uint32_t i) {
  Photon p;
  p.position = {float(i), 1.0f / float(i + 1), -float(i) * 0.37f};
  p.flux = {float(i % 7) * 1e-3f, 1.0f / float(i + 3), float(i) * 1e5f};
  p.normal = {std::uint16_t(i * 7919 % 65535), std::uint16_t(i * 104729 % 65535)};
  p.object = std::uint16_t(i * 31);
  p.kind = PathKind(i % 3);
  p.bounce = std::uint8_t(i);
  return p;
}

/// `count` photons of a group, with columns.
inline PhotonBlock block_of(std::uint32_t group, std::uint32_t count, std::uint32_t columns, std::uint32_t first = 0) {
  PhotonBlock block;
  block.group = group;
  for (std::uint32_t i = first; i < first + count; ++i) {
    block.photons.push_back(photon(i + 1000 * group));
    if (columns & column_direction)
      block.directions.push_back({std::uint16_t(i % 65535), std::uint16_t(i * 3 % 65535)});
    if (columns & column_albedo)
      block.albedos.push_back({std::uint8_t(i), std::uint8_t(i * 5), std::uint8_t(i * 9), 0});
  }
  return block;
}

inline std::vector<GroupFlux> ledger_of(const std::vector<std::uint32_t>& groups, double scale = 1) {
  std::vector<GroupFlux> ledger;
  for (std::uint32_t g : groups) {
    const double x = scale * (1 + 0.1 * g);
    ledger.push_back({g, {x, 2 * x, 3 * x}, {0.1 * x, 0.2 * x, 0.3 * x}, {0.9 * x, 1.8 * x, 2.7 * x}, 0, 0, {}});
  }
  return ledger;
}

}  // namespace tempolux::formats::testing
