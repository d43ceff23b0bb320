#include "lib/photon/photon_update.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <set>

#include "formats/error.h"
#include "formats/photons/file_reader.h"
#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/photon/photon_ledger.h"

namespace tempolux {
namespace {

std::string file_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

std::uint64_t draw(int frame, std::uint32_t group) {
  return mix64(mix64(std::uint64_t(std::uint32_t(frame)) + 0x75706474ull) + group);
}

/// Reads the photons of the groups that an update keeps.
class KeptPhotons {
 public:
  /// own_only: reads only the groups that the earlier map, an overlay, holds itself. none: reads nothing, because the
  /// base of the new map holds all kept groups.
  KeptPhotons(const MapUpdate& update, bool own_only, bool none) : previous_(update.previous), none_(none) {
    if (previous_.is_kept() || none) return;
    if (own_only) file_ = std::make_unique<formats::photons::FileReader>(update.path);
    else whole_ = std::make_unique<formats::PhotonReader>(update.path, formats::PhotonReadOptions{.digest = false});
    read();
  }
  /// Calls take(block) for each block of the group. Skips blocks of earlier groups, so `group` must ascend.
  template <class Take>
  void of(std::uint32_t group, const Take& take) {
    if (previous_.is_kept() && !none_)
      for (const formats::PhotonBlock& block : previous_.photons[group]) take(block);
    while (more_ && next_.group < group) read();
    for (; more_ && next_.group == group; read()) take(next_);
  }
  /// Reads to the end, so that the file is checked.
  void finish() {
    while (more_) read();
  }

 private:
  void read() { more_ = file_ ? file_->read_block(next_) : whole_->read_block(next_); }

  const PreviousMap& previous_;
  bool none_, more_ = false;
  std::unique_ptr<formats::photons::FileReader> file_;
  std::unique_ptr<formats::PhotonReader> whole_;
  formats::PhotonBlock next_;
};

/// The groups that differ from the base after the update.
std::set<std::uint32_t> groups_beside_base(const MapUpdate& update) {
  std::set<std::uint32_t> groups;
  const PreviousMap& previous = update.previous;
  if (!previous.header.base_name.empty()) groups = previous.is_kept() ? previous.own : own_groups(update.path);
  groups.insert(update.groups.begin(), update.groups.end());
  return groups;
}

}  // namespace

std::string why_not_updatable(const formats::PhotonHeader& a, const formats::PhotonHeader& b) {
  if (a.map != b.map || !a.part.empty()) return "it is a part of a map";
  if (a.kinds != b.kinds) return "it has other kinds of photons (" + a.kinds + ")";
  if (a.majorants.empty()) return "it has no photons in media: only such maps store how old their groups are";
  if (a.majorants != b.majorants)
    return "its majorants are others: make all maps of a segment with the same --majorants";
  if (a.group_count != b.group_count || a.emitted_count != b.emitted_count)
    return "it has another number of groups or paths";
  if (a.pilots != b.pilots)
    return "it has " + std::to_string(a.pilots) + " pilots in each group, not " + std::to_string(b.pilots);
  if (a.columns != b.columns) return "it has other columns";
  if (a.origin != b.origin) return "it has another origin";
  if (a.identity.emission != b.identity.emission)
    return "its paths were started by another table of lamps: it is of another segment";
  return "";
}

std::vector<std::uint32_t> choose_groups(const PreviousMap& previous, int frame, bool same,
                                         const UpdateOptions& options) {
  const std::uint32_t count = previous.header.group_count;
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  if (options.strategy == UpdateStrategy::all) return order;
  if (same) return {};
  std::vector<double> priority(count);
  for (std::uint32_t g = 0; g < count; ++g) {
    const double age = std::max(0, frame - previous.ledger[g].frame);
    priority[g] = options.strategy == UpdateStrategy::random   ? 1
                  : options.strategy == UpdateStrategy::oldest ? age
                                                               : std::pow(age, options.age_power) * previous.change[g];
  }
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    if (priority[a] != priority[b]) return priority[a] > priority[b];
    return std::pair(draw(frame, a), a) < std::pair(draw(frame, b), b);
  });
  order.resize(std::size_t(std::min<std::uint64_t>(options.most_groups, count)));
  std::erase_if(order, [&](std::uint32_t g) { return !(priority[g] > 0); });
  std::ranges::sort(order);
  return order;
}

PhotonMapResult write_updated_map(const PhotonTracer& tracer, formats::PhotonHeader header, const MapUpdate& update,
                                  const std::function<void(const void*, std::size_t)>& sink) {
  PreviousMap& previous = update.previous;
  const std::span<const std::uint32_t> groups = update.groups;
  describe_map(tracer, header);
  const bool upon_overlay = !previous.header.base_name.empty();
  std::set<std::uint32_t> differing = groups_beside_base(update);
  const bool overlay = update.may_overlay && differing.size() * 2 <= header.group_count;
  if (overlay) {
    header.base_name = upon_overlay ? previous.header.base_name : file_name(update.path);
    header.base_digest = upon_overlay ? previous.header.base_digest : previous.digest;
  }
  PhotonMapResult result;
  formats::PhotonWriter writer(sink, header);
  KeptPhotons kept(update, overlay, overlay && !upon_overlay);
  std::vector<formats::GroupFlux> ledger;
  std::uint32_t next = 0;
  const auto keep_until = [&](std::uint32_t end) {
    for (; next < end; ++next) {
      if (overlay && !differing.contains(next)) continue;
      bool any = false;
      kept.of(next, [&](const formats::PhotonBlock& block) { writer.write(block), any = true; });
      if (overlay && !any) writer.write({next, {}, {}, {}});
      ledger.push_back(previous.ledger[next]);
    }
  };
  make_in_order(
      groups.size(), [&](std::size_t i) { return trace_group(tracer, groups[i], 0, tracer.members()); },
      [&](std::size_t i, std::vector<PhotonBatch>& batches) {
        keep_until(groups[i]);
        formats::GroupFlux entry;
        bool any = false;
        if (previous.is_kept()) previous.photons[groups[i]].clear();
        for (PhotonBatch& batch : batches) {
          add_to_ledger(batch, header.identity.first_frame, entry);
          result.add(batch);
          if (batch.block.photons.empty()) continue;
          writer.write(batch.block), any = true;
          if (previous.is_kept()) previous.photons[groups[i]].push_back(std::move(batch.block));
        }
        if (overlay && !any) writer.write({groups[i], {}, {}, {}});
        clamp_absorbed(entry.absorbed);
        ledger.push_back(entry);
        next = groups[i] + 1;
      });
  keep_until(header.group_count);
  kept.finish();
  result.totals = writer.finish({}, ledger);
  if (!overlay) previous.photons.clear();  // a map is kept in memory only if its file is an overlay
  if (previous.is_kept()) previous.become(header, ledger, std::move(differing));
  return result;
}

}  // namespace tempolux
