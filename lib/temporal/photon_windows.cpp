#include "lib/temporal/photon_windows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tuple>
#include <unordered_map>

#include "formats/octahedral.h"
#include "lib/core/parallel_each.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr std::size_t kChunk = 1024;  ///< elements that one task processes
constexpr int kRegions = 3;           ///< regions whose tests count as false alarms: element, kernel, ring
/// Expected number of photons of equal flux in a block that is tested. The distribution of fewer photons does not have
/// Gaussian tails.
constexpr double kPhotonsInBlock = 8;

constexpr double kLargestSum = 0x1p55;  ///< largest sum of one frame, so that sums over 255 frames do not overflow

/// Last distance of the block that starts at `distance`: blocks have 1, 1, 2, 4, 8 ... frames.
int block_end(int distance) { return distance == 0 ? 1 : 2 * distance; }

/// x with P(|Gaussian| > x) = p.
double two_sided_quantile(double p) {
  double low = 0, high = 40;
  for (int i = 0; i < 80; ++i) {
    const double middle = (low + high) / 2;
    (std::erfc(middle / std::numbers::sqrt2) > p ? low : high) = middle;
  }
  return low;
}

/// Numbers of frames that are added to a window on each side.
struct Added {
  int before = 0, after = 0;
  int frames() const { return before + after; }
};

/// The sides of a window to which something applies.
struct Sides {
  bool before = false, after = false;
  bool any() const { return before || after; }
};

/// Calls visit(from, to) for each step by which a window grows on one side: the last frame's distance from the window's
/// middle before and after the step. The frames of a block are visited one by one, then as a block.
template <class Visit>
void each_step(int reach, const Visit& visit) {
  for (int start = 0; start < reach; start = block_end(start)) {
    const int end = std::min(block_end(start), reach);
    for (int distance = start; distance < end; ++distance) visit(distance, distance + 1);
    if (end > start + 1) visit(start, end);
  }
}

/// Number of tests for a region of `rate` photons of equal flux per frame while a window grows to its full size.
int tests_of(double rate, const Added& most, int reach) {
  int tests = 0;
  each_step(reach, [&](int from, int to) {
    const auto frames = [&](int distance) {
      return 1 + std::min(distance, most.before) + std::min(distance, most.after);
    };
    const int old = frames(from), added = frames(to) - old;
    tests += added > 0 && std::min(old, added) * rate >= kPhotonsInBlock;
  });
  return tests;
}

/// Decides whether frames may join a window.
class Grower {
 public:
  Grower(const WindowSeries& series, int at, int frames, const Added& most, const WindowThresholds& thresholds)
      : series_(series), at_(at) {
    int tests = 0;
    for (const HitSeries* region : {series.element, series.kernel, series.ring})
      tests += tests_of(region->block(0, frames - 1).equal_photons() / frames, most, thresholds.reach());
    threshold_ = thresholds.of(tests);
  }

  /// The sides on which the added frames may join the window. If both sides together do not differ from the window,
  /// both may join. Otherwise a side may join if the other side differs and it does not. If neither side differs by
  /// itself, light passes through an extreme at the middle, and neither may join.
  Sides sides(const Window& window, const Added& added) const {
    if (added.frames() == 0 || !differs(window, added)) return {true, true};
    const bool before = added.before > 0 && differs(window, {added.before, 0});
    const bool after = added.after > 0 && differs(window, {0, added.after});
    return {after && !before && added.before > 0, before && !after && added.after > 0};
  }

 private:
  /// True if the light of the added frames differs from the window's light.
  bool differs(const Window& window, const Added& added) const {
    const HitBlock kernel = all_of(*series_.kernel, window, added);
    return rejects(*series_.element, window, added) || rejects(*series_.kernel, window, added) ||
           (rejects(*series_.ring, window, added) && matters(*series_.ring, window, added, kernel)) ||
           (rejects(*series_.frame, window, added) && matters(*series_.frame, window, added, kernel));
  }
  HitBlock old_of(const HitSeries& s, const Window& w) const { return s.block(at_ - w.before, at_ + w.after); }
  HitBlock added_of(const HitSeries& s, const Window& w, const Added& a) const {
    HitBlock block;
    if (a.before > 0) block += s.block(at_ - w.before - a.before, at_ - w.before - 1);
    if (a.after > 0) block += s.block(at_ + w.after + 1, at_ + w.after + a.after);
    return block;
  }
  HitBlock all_of(const HitSeries& s, const Window& w, const Added& a) const {
    return old_of(s, w) + added_of(s, w, a);
  }

  bool rejects(const HitSeries& s, const Window& w, const Added& a) const {
    const int old_frames = w.before + 1 + w.after;
    const HitBlock old = old_of(s, w), added = added_of(s, w, a);
    const double p = double(std::min(old_frames, a.frames())) / (old_frames + a.frames());
    if ((old + added).equal_photons() * p < kPhotonsInBlock) return false;
    return std::abs(block_contrast(old, old_frames, added, a.frames())) > threshold_;
  }
  /// True if the added frames shift the mean of the region by more than they reduce the noise of the kernel's mean.
  bool matters(const HitSeries& s, const Window& w, const Added& a, const HitBlock& kernel) const {
    const double old_frames = w.before + 1 + w.after, frames = old_frames + a.frames();
    const HitBlock all = all_of(s, w, a);
    if (!(all.flux > 0) || !(kernel.flux > 0)) return all.flux > 0;
    const double shift = old_of(s, w).flux / all.flux * frames / old_frames - 1;  // of the mean, relative
    return shift * shift > kernel.squares / (kernel.flux * kernel.flux) * (frames / old_frames - 1);
  }

  const WindowSeries& series_;
  int at_;
  double threshold_ = 0;
};

/// The photons of each element by frame: entries [first[i], first[i + 1]).
struct HitTable {
  struct Entry {
    const formats::MeshElement* counted;
    std::uint32_t frame;
  };
  std::vector<std::size_t> first;
  std::vector<Entry> entries;
  std::span<const Entry> of(std::size_t element) const {
    return {entries.data() + first[element], first[element + 1] - first[element]};
  }
};

HitTable table_of(std::span<const FrameCounts* const> frames, const std::vector<formats::MeshElement>& elements) {
  std::unordered_map<std::uint64_t, std::size_t> sides;  // first element
  const auto key = [](const formats::MeshElement& e) {
    return std::uint64_t(e.surface) << 32 | std::uint64_t(e.triangle) << 1 | e.side;
  };
  for (std::size_t i = 0; i < elements.size(); i += std::size_t(elements[i].cuts) * elements[i].cuts)
    sides.emplace(key(elements[i]), i);
  const auto each = [&](const auto& visit) {
    for (std::uint32_t f = 0; f < frames.size(); ++f)
      for (const formats::MeshElement& e : frames[f]->elements) {
        const auto found = sides.find(key(e));
        if (found == sides.end()) continue;  // the element has no area at this frame
        if (elements[found->second].cuts != e.cuts)
          throw std::invalid_argument("collect_windows: a triangle is cut otherwise in frame " +
                                      std::to_string(frames[f]->frame));
        visit(found->second + e.cell, HitTable::Entry{&e, f});
      }
  };
  HitTable table;
  table.first.assign(elements.size() + 1, 0);
  each([&](std::size_t i, const HitTable::Entry&) { ++table.first[i + 1]; });
  for (std::size_t i = 0; i < elements.size(); ++i) table.first[i + 1] += table.first[i];
  table.entries.resize(table.first.back());
  std::vector<std::size_t> next(table.first.begin(), table.first.end() - 1);
  each([&](std::size_t i, const HitTable::Entry& entry) { table.entries[next[i]++] = entry; });
  return table;
}

/// Unit of an entry's sums.
double unit_of(std::span<const FrameCounts* const> frames, const HitTable::Entry& entry) {
  return frames[entry.frame]->unit;
}

HitBlock hits_of(const formats::MeshElement& e, double unit) {
  return {double(e.photons), unit * luminance(Rgbd(double(e.sums[0]), double(e.sums[1]), double(e.sums[2]))),
          unit * unit * e.squares()};
}

/// Groups elements into regions: the elements in one cube that face along one axis and belong to one object.
class Regions {
 public:
  Regions(std::size_t frames, double edge) : frames_(frames), per_m_(1 / edge) {}
  /// Adds an element to its region; returns the region's number.
  std::uint32_t add(const formats::MeshElement& e) {
    const auto n = formats::decode_normal(e.normal);
    std::size_t axis = 0;
    for (std::size_t c = 1; c < 3; ++c)
      if (std::abs(n[c]) > std::abs(n[axis])) axis = c;
    std::uint64_t key = mix64(std::uint64_t(e.object) * 6 + axis * 2 + (n[axis] < 0));
    for (std::size_t c = 0; c < 3; ++c)
      key = mix64(key + std::uint64_t(std::int64_t(std::floor(double(e.position[c]) * per_m_))));
    const auto [found, is_new] = numbers_.try_emplace(key, std::uint32_t(all_.size()));
    if (is_new) all_.push_back({HitSeries(frames_), 0});
    all_[found->second].area += double(e.area);
    return found->second;
  }
  struct Region {
    HitSeries series;
    double area;  ///< m^2
  };
  Region& operator[](std::uint32_t region) { return all_[region]; }
  const Region& operator[](std::uint32_t region) const { return all_[region]; }
  void sum_up() {
    for (Region& r : all_) r.series.sum_up();
  }

 private:
  std::size_t frames_;
  double per_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
  std::vector<Region> all_;
};

/// The two regions around each element: kernel and ring.
class Surroundings {
 public:
  /// `edge` [m] of the cubes of the kernels.
  Surroundings(std::span<const FrameCounts* const> frames, const HitTable& table,
               const std::vector<formats::MeshElement>& elements, double edge)
      : kernels_(frames.size(), edge), rings_(frames.size(), 3 * edge), all_(frames.size()), of_(elements.size()) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      of_[i] = {kernels_.add(elements[i]), rings_.add(elements[i])};
      for (const HitTable::Entry& entry : table.of(i)) {
        const HitBlock hits = hits_of(*entry.counted, unit_of(frames, entry));
        kernels_[of_[i][0]].series.at(entry.frame) += hits;
        rings_[of_[i][1]].series.at(entry.frame) += hits;
        all_.at(entry.frame) += hits;
      }
    }
    kernels_.sum_up();
    rings_.sum_up();
    all_.sum_up();
  }
  const HitSeries& kernel(std::size_t element) const { return kernels_[of_[element][0]].series; }
  double kernel_area(std::size_t element) const { return kernels_[of_[element][0]].area; }
  const HitSeries& ring(std::size_t element) const { return rings_[of_[element][1]].series; }
  const HitSeries& all() const { return all_; }

 private:
  Regions kernels_, rings_;
  HitSeries all_;
  std::vector<std::array<std::uint32_t, 2>> of_;
};

/// First and last frame around `at` between which light does not jump.
std::pair<int, int> between_jumps(std::span<const FrameCounts* const> frames, int at) {
  int first = at, last = at;
  while (first > 0 && !frames[std::size_t(first)]->jump) --first;
  while (last + 1 < int(frames.size()) && !frames[std::size_t(last) + 1]->jump) ++last;
  return {first, last};
}

/// A window, its middle frame, and whether the element's size may differ from frame to frame.
struct PlacedWindow {
  int now = 0;
  Window window;
  bool changes_size = false;
};

/// Adds the window's photons to the element. Returns the mean flux per frame [unit of the counts], scaled to the
/// element's present area, and the variance of this mean.
std::pair<Rgbd, double> put_window(std::span<const FrameCounts* const> frames, std::span<const HitTable::Entry> entries,
                                   const PlacedWindow& placed, formats::MeshElement& e) {
  const auto& [now, window, changes_size] = placed;
  e.before = std::uint8_t(window.before);
  e.after = std::uint8_t(window.after);
  Rgbd flux{0.0};
  double squares = 0;
  for (const HitTable::Entry& entry : entries) {
    if (int(entry.frame) < now - window.before || int(entry.frame) > now + window.after) continue;
    const formats::MeshElement& counted = *entry.counted;
    const double size = changes_size && counted.area > 0 ? double(e.area) / double(counted.area) : 1;
    e.photons += counted.photons;
    squares += size * size * hits_of(counted, unit_of(frames, entry)).squares;
    for (std::size_t c = 0; c < 3; ++c) {
      const double sum = unit_of(frames, entry) * double(counted.sums[c]);
      e.sums[c] += std::llrint(std::min(sum, kLargestSum));
      flux[int(c)] += size * sum;
    }
  }
  const double per_frame = 1 / double(window.before + 1 + window.after);
  return {flux * per_frame, squares * per_frame * per_frame};
}

}  // namespace

double block_contrast(const HitBlock& old, int old_frames, const HitBlock& added, int added_frames) {
  const double p = double(added_frames) / (old_frames + added_frames), flux = old.flux + added.flux,
               squares = old.squares + added.squares;
  if (!(squares > 0)) return 0;
  const double z = (added.flux - p * flux) / std::sqrt(p * (1 - p) * squares);
  const double skewness = (1 - 2 * p) / std::sqrt(p * (1 - p)) * std::sqrt(squares) / flux;
  return z - skewness * (z * z - 1) / 6;
}

WindowThresholds::WindowThresholds(const WindowOptions& options) : reach_(options.reach) {
  int most = 0;
  each_step(reach_, [&](int, int) { most += kRegions; });
  for (int tests = 0; tests <= most; ++tests)
    by_tests_.push_back(two_sided_quantile(-std::expm1(std::log1p(-options.false_alarms) / std::max(1, tests))));
}

void HitSeries::sum_up() {
  for (std::size_t i = 1; i < until_.size(); ++i) until_[i] += until_[i - 1];
}

Window grow_window(const WindowSeries& series, int at, int frames, const WindowThresholds& thresholds) {
  const int reach = thresholds.reach();
  const Added most{std::min(at, reach), std::min(frames - 1 - at, reach)};
  const Grower grower(series, at, frames, most, thresholds);
  Window window;
  Sides open{most.before > 0, most.after > 0};
  for (int start = 0; open.any() && start < reach; start = block_end(start)) {
    const int end = std::min(block_end(start), reach);
    const Window old = window;
    for (int distance = start + 1; distance <= end; ++distance) {
      const Added added{open.before ? std::max(0, std::min(distance, most.before) - window.before) : 0,
                        open.after ? std::max(0, std::min(distance, most.after) - window.after) : 0};
      const Sides sides = grower.sides(window, added);
      open = {open.before && sides.before, open.after && sides.after};
      if (sides.before) window.before += added.before;
      if (sides.after) window.after += added.after;
    }
    if (end > start + 1) {
      const Sides sides = grower.sides(old, {window.before - old.before, window.after - old.after});
      if (!sides.before) window.before = old.before;
      if (!sides.after) window.after = old.after;
      open = {open.before && sides.before, open.after && sides.after};
    }
    open = {open.before && window.before < most.before, open.after && window.after < most.after};
  }
  return window;
}

CollectedLight collect_windows(std::span<const FrameCounts* const> frames, std::size_t at, std::uint32_t moving,
                               const WindowOptions& options, std::vector<formats::MeshElement>& elements) {
  const auto [first, last] = between_jumps(frames, int(at));
  frames = frames.subspan(std::size_t(first), std::size_t(last - first + 1));
  const int now = int(at) - first;
  const HitTable table = table_of(frames, elements);
  const Surroundings around(frames, table, elements, std::sqrt(4 * std::numbers::pi) * options.width);
  const WindowThresholds thresholds(options);
  const double full = 2 * options.reach + 1;  // frames
  double area = 0;                            // m^2, one side
  for (const formats::MeshElement& e : elements) area += double(e.area) / 2;
  const double density = around.all().block(0, int(frames.size()) - 1).photons / double(frames.size()) * full / area;
  CollectedLight result{{std::vector<Rgbd>(elements.size(), Rgbd(0.0)), std::vector<double>(elements.size(), 0)},
                        std::vector<float>(elements.size(), 0)};
  parallel_each(elements.size(), kChunk, [&](std::size_t i) {
    const HitSeries& kernel = around.kernel(i);
    if (kernel.block(0, int(frames.size()) - 1).photons == 0) return;
    HitSeries own(frames.size());
    for (const HitTable::Entry& entry : table.of(i))
      own.at(entry.frame) += hits_of(*entry.counted, unit_of(frames, entry));
    own.sum_up();
    const Window window =
        grow_window({&own, &kernel, &around.ring(i), &around.all()}, now, int(frames.size()), thresholds);
    std::tie(result.flux.mean[i], result.flux.squares[i]) =
        put_window(frames, table.of(i), {now, window, elements[i].surface >= moving}, elements[i]);
    const double photons = kernel.block(now - window.before, now + window.after).photons;
    const double fewer = density * around.kernel_area(i) / std::max(1.0, photons);
    result.widths[i] = float(options.width * std::sqrt(std::sqrt(std::clamp(fewer, 1.0, full))));
  });
  return result;
}

}  // namespace tempolux
