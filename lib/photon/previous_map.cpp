#include "lib/photon/previous_map.h"

#include <cmath>
#include <optional>
#include <span>

#include "formats/error.h"
#include "formats/photons/file_reader.h"
#include "lib/core/arrays.h"
#include "lib/core/parallel_each.h"
#include "lib/photon/photon_ledger.h"

namespace tempolux {
namespace {

constexpr std::size_t kGroupsTogether = 16;  ///< groups whose pilots one task traces

/// PreviousMap::change of a group with these pilots.
double difference(UpdateStrategy strategy, std::span<const formats::PhotonPilot> then,
                  std::span<const formats::PhotonPilot> now) {
  double sum = 0;
  for (std::size_t i = 0; i < std::min(then.size(), now.size()); ++i) {
    const bool collides_elsewhere = then[i].collisions != now[i].collisions;
    switch (strategy) {
      case UpdateStrategy::fde: sum += then[i].extinctions != now[i].extinctions; break;
      case UpdateStrategy::dip: sum += collides_elsewhere; break;
      case UpdateStrategy::path: sum += collides_elsewhere || then[i].vertices != now[i].vertices; break;
      default: sum += std::abs(then[i].sketch - now[i].sketch);
    }
  }
  return strategy == UpdateStrategy::hybrid ? sum : sum / double(std::max<std::size_t>(1, then.size()));
}

/// Traces the pilots of all groups through the tracer's scene and sets PreviousMap::change.
void send_pilots(UpdateStrategy strategy, const PhotonTracer& tracer, PreviousMap& previous) {
  const std::uint32_t pilots = previous.header.pilots;
  previous.change.assign(previous.ledger.size(), 0.0);
  parallel_each(previous.ledger.size(), kGroupsTogether, [&](std::size_t g) {
    previous.change[g] =
        difference(strategy, previous.ledger[g].pilots, tracer.trace_members(std::uint32_t(g), 0, pilots).pilots);
  });
  previous.pilot_paths = std::uint64_t(pilots) * previous.ledger.size();
}

/// Measures the change of extinction at the stored photons. Media are not evaluated in cells of the majorants that are
/// empty in this frame.
class Census {
 public:
  Census(const PhotonTracer& tracer, Vec3 offset) : tracer_(tracer), offset_(offset) {
    if (!tracer.media() || tracer.majorants().empty()) return;
    now_ = MajorantGrid(tracer.majorants().box(), tracer.majorants().counts());
    raise_majorants(tracer.media()->all(), now_);
  }
  /// Sum over the block's tentative photons of flux x |extinction now - then|, W.
  double of(const formats::PhotonBlock& block) const {
    double sum = 0;
    for (const formats::Photon& photon : block.photons) {
      if (photon.kind != formats::PathKind::tentative) continue;
      const Vec3 position = vec_of(photon.position) + offset_;
      const std::size_t cell = now_.index_of(position);
      if (cell == now_.values().size()) continue;
      const float now = now_.values()[cell] > 0 ? tracer_.media()->extinction(position) : 0;
      const float then = extinction_when_recorded(photon, tracer_.majorants().values()[cell]);
      if (now != then)
        sum += double((photon.flux[0] + photon.flux[1] + photon.flux[2]) / 3) * double(std::abs(now - then));
    }
    return sum;
  }

 private:
  const PhotonTracer& tracer_;
  Vec3 offset_;
  MajorantGrid now_;  ///< greatest extinction of this frame, by cell
};

Vec3 offset_of(const formats::PhotonHeader& header, Vec3d origin) { return Vec3(vec_of(header.origin) - origin); }

void need_pilots(const std::string& path, const PreviousMap& previous, UpdateStrategy strategy) {
  if (sends_pilots(strategy) && previous.header.pilots == 0)
    throw InputError(path +
                     ": has no pilots, which fde, dip, hybrid and path compare; trace the segment's first map with "
                     "--pilots 3%, or choose another --strategy");
}

}  // namespace

std::set<std::uint32_t> own_groups(const std::string& path) {
  formats::photons::FileReader reader(path);
  std::set<std::uint32_t> groups;
  formats::PhotonBlock block;
  while (reader.read_block(block)) groups.insert(block.group);
  return groups;
}

PreviousMap read_previous(const std::string& path, const PhotonTracer& tracer, UpdateStrategy strategy, Vec3d origin,
                          bool keep) {
  formats::PhotonReader reader(path);
  PreviousMap previous;
  previous.header = reader.header();
  need_pilots(path, previous, strategy);
  std::optional<Census> census;
  if (strategy == UpdateStrategy::census && !keep) {
    census.emplace(tracer, offset_of(previous.header, origin));
    previous.change.assign(previous.header.group_count, 0.0);
  }
  if (keep) previous.photons.resize(previous.header.group_count);
  formats::PhotonBlock block;
  while (reader.read_block(block)) {
    if (census) previous.change[block.group] += census->of(block);
    if (keep) previous.photons[block.group].push_back(std::move(block));
  }
  previous.ledger = reader.ledger();
  previous.digest = reader.digest();
  if (keep && !previous.header.base_name.empty()) previous.own = own_groups(path);
  if (!keep && sends_pilots(strategy)) send_pilots(strategy, tracer, previous);
  return previous;
}

void find_change(const std::string& path, PreviousMap& previous, const PhotonTracer& tracer, UpdateStrategy strategy,
                 Vec3d origin) {
  need_pilots(path, previous, strategy);
  previous.pilot_paths = 0;
  if (sends_pilots(strategy)) return send_pilots(strategy, tracer, previous);
  if (strategy != UpdateStrategy::census) return previous.change.clear();
  const Census census(tracer, offset_of(previous.header, origin));
  previous.change.assign(previous.header.group_count, 0.0);
  parallel_each(previous.photons.size(), kGroupsTogether, [&](std::size_t g) {
    for (const formats::PhotonBlock& block : previous.photons[g]) previous.change[g] += census.of(block);
  });
}

}  // namespace tempolux
