#include "lib/photon/photon_refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>

#include "formats/error.h"
#include "lib/core/arrays.h"
#include "lib/core/halton.h"
#include "lib/core/parallel.h"
#include "lib/photon/photon_ledger.h"

namespace tempolux {
namespace {

void scale(std::vector<formats::Photon>& photons, double factor) {
  for (formats::Photon& photon : photons)
    for (float& flux : photon.flux) flux = float(double(flux) * factor);
}

/// Scales all photons and sums of flux of a batch.
void scale(PhotonBatch& batch, double factor) {
  scale(batch.block.photons, factor);
  for (Rgbd* flux : {&batch.emitted, &batch.escaped, &batch.absorbed}) *flux = *flux * factor;
}

}  // namespace

std::vector<std::uint64_t> spread_paths(std::span<const double> moments, std::span<const std::uint64_t> paths,
                                        std::uint64_t extra) {
  const std::size_t n = moments.size();
  std::vector<std::uint64_t> result(paths.begin(), paths.end());
  if (n == 0 || extra == 0) return result;
  std::vector<double> wanted(n);
  const bool dark = std::ranges::all_of(moments, [](double m) { return !(m > 0); });
  for (std::size_t g = 0; g < n; ++g) wanted[g] = dark ? 1 : std::sqrt(std::max(0.0, moments[g]));
  // The level of a group is paths / sqrt(moment). All groups that get further paths end at one common level, as vessels
  // that are filled. Sorts the groups by their levels and finds the common level at which `extra` paths are used up.
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t(0));
  const auto begins = [&](std::size_t g) { return wanted[g] > 0 ? double(paths[g]) / wanted[g] : INFINITY; };
  std::ranges::sort(order,
                    [&](std::size_t a, std::size_t b) { return std::pair(begins(a), a) < std::pair(begins(b), b); });
  double weight = 0, had = 0, level = 0;
  std::size_t count = 0;
  for (; count < n && begins(order[count]) < INFINITY; ++count) {
    if (count > 0 && level <= begins(order[count])) break;
    weight += wanted[order[count]];
    had += double(paths[order[count]]);
    level = (had + double(extra)) / weight;
  }
  // Rounds each number down; the groups with the largest remainders get one path more.
  std::vector<std::pair<double, std::size_t>> rests;
  std::uint64_t spent = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t g = order[i];
    const double more = std::max(0.0, level * wanted[g] - double(paths[g]));
    const auto whole = std::min(std::uint64_t(more), extra - spent);
    result[g] += whole;
    spent += whole;
    rests.emplace_back(double(whole) - more, g);
  }
  std::ranges::sort(rests);
  for (std::size_t i = 0; spent < extra; i = (i + 1) % rests.size(), ++spent) ++result[rests[i].second];
  return result;
}

std::vector<double> neighbour_means(std::span<const double> values, std::uint64_t seed) {
  constexpr std::array<std::size_t, 4> bases{3, 5, 7, 2};  // bases of PhotonHalton's components
  const std::size_t count = values.size();
  std::array<std::size_t, 4> sides{1, 1, 1, 1};
  std::size_t left = count;
  for (std::size_t a = 0; a < 4; ++a)
    for (; left > 1 && left % bases[a] == 0; left /= bases[a]) sides[a] *= bases[a];
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / double(std::max<std::size_t>(1, count));
  std::vector<double> result(count, mean);
  if (left != 1 || count < 2) return result;
  const PhotonHalton halton(seed);
  std::vector<std::array<std::size_t, 4>> box_of(count);
  std::vector<std::size_t> group_in(count);
  const auto number = [&](const std::array<std::size_t, 4>& box) {
    std::size_t n = 0;
    for (std::size_t a = 0; a < 4; ++a) n = n * sides[a] + box[a];
    return n;
  };
  for (std::size_t g = 0; g < count; ++g) {
    const std::array<double, 4> start = halton.point(g);
    for (std::size_t a = 0; a < 4; ++a) box_of[g][a] = std::min(std::size_t(start[a] * double(sides[a])), sides[a] - 1);
    group_in[number(box_of[g])] = g;
  }
  for (std::size_t g = 0; g < count; ++g) {
    double sum = 0;
    int beside = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (const bool up : {false, true}) {
        std::array<std::size_t, 4> box = box_of[g];
        if (up ? box[a] + 1 == sides[a] : box[a] == 0) continue;
        box[a] += up ? 1 : std::size_t(-1);
        sum += values[group_in[number(box)]];
        ++beside;
      }
    result[g] = sum / beside;
  }
  return result;
}

GroupMoments read_moments(const std::string& path, const PhotonTracer& tracer) {
  formats::PhotonReader reader(path, {.digest = false});
  GroupMoments groups;
  groups.header = reader.header();
  if (groups.header.majorants.empty())
    throw InputError(path + ": has no photons in media; trace it with --kinds volume among others");
  if (groups.header.majorants != tracer.majorants().hash())
    throw InputError(
        path + ": its majorants are others than those of this frame; give the --majorants that it was traced with");
  std::vector<double> squares(groups.header.group_count);
  formats::PhotonBlock block;
  while (reader.read_block(block))
    for (const formats::Photon& photon : block.photons) {
      if (photon.kind != formats::PathKind::tentative) continue;
      const Vec3 position = vec_of(photon.position);
      const double collides = double((photon.flux[0] + photon.flux[1] + photon.flux[2]) / 3) *
                              double(tracer.media() ? tracer.media()->extinction(position) : 0);
      squares[block.group] += collides * collides;
    }
  groups.ledger = reader.ledger();
  for (const formats::GroupFlux& entry : groups.ledger) {
    const auto n = double(std::max<std::uint64_t>(1, entry.paths));
    groups.paths.push_back(entry.paths);
    // Stored flux is divided by n, and the moment is that of undivided flux, so the squares get the factor n^2. The
    // mean over n paths divides by n.
    groups.moments.push_back(squares[entry.group] * n);
  }
  groups.moments = neighbour_means(groups.moments, tracer.seed());
  return groups;
}

PhotonMapResult write_refined_map(const PhotonTracer& tracer, formats::PhotonHeader header, const std::string& path,
                                  const GroupMoments& groups, std::uint64_t extra,
                                  const std::function<void(const void*, std::size_t)>& sink) {
  describe_map(tracer, header);
  const std::vector<std::uint64_t> paths = spread_paths(groups.moments, groups.paths, extra);
  header.emitted_count = std::accumulate(paths.begin(), paths.end(), std::uint64_t(0));
  PhotonMapResult result;
  formats::PhotonWriter writer(sink, header);
  formats::PhotonReader reader(path, {.digest = false});
  formats::PhotonBlock block;
  bool more = reader.read_block(block);
  std::vector<formats::GroupFlux> ledger = groups.ledger;
  make_in_order(
      paths.size(),
      [&](std::size_t g) {
        std::vector<PhotonBatch> fresh = trace_group(tracer, std::uint32_t(g), groups.paths[g], paths[g]);
        // The tracer divides flux by members(), and the new map by paths[g].
        for (PhotonBatch& batch : fresh)
          scale(batch, double(tracer.members()) / double(std::max<std::uint64_t>(1, paths[g])));
        return fresh;
      },
      [&](std::size_t g, const std::vector<PhotonBatch>& fresh) {
        const double factor = double(groups.paths[g]) / double(std::max<std::uint64_t>(1, paths[g]));
        for (; more && block.group == g; more = reader.read_block(block)) {
          if (factor != 1) scale(block.photons, factor);
          writer.write(block);
        }
        formats::GroupFlux& entry = ledger[g];
        for (auto* flux : {&entry.emitted, &entry.escaped, &entry.absorbed})
          for (double& f : *flux) f *= factor;
        for (const PhotonBatch& batch : fresh) {
          if (!batch.block.photons.empty()) writer.write(batch.block);
          const std::int32_t frame = entry.frame;
          add_to_ledger(batch, frame, entry);
          result.add(batch);
        }
        clamp_absorbed(entry.absorbed);
      });
  result.totals = writer.finish({}, ledger);
  return result;
}

}  // namespace tempolux
