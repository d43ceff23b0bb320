#include "lib/light/emission_parts.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel_each.h"

namespace tempolux {
namespace {

constexpr int kMostCuts = 8;

TrianglePart quarter(const TrianglePart& of, int which) {
  const float half = of.size / 2;
  const Vec2 c = of.corner;
  switch (which) {
    case 0: return {c, half};
    case 1: return {{c.x + half, c.y}, half};
    case 2: return {{c.x, c.y + half}, half};
    default: return {{c.x + half, c.y + half}, -half};
  }
}

/// The code of the piece of the finest size at (b1, b2).
std::uint32_t code_at(double b1, double b2) {
  std::uint32_t code = 0;
  for (int cut = 0; cut < kMostCuts; ++cut) {
    b1 *= 2;
    b2 *= 2;
    const std::uint32_t which = b1 > 1 ? 1 : b2 > 1 ? 2 : b1 + b2 > 1 ? 3 : 0;
    if (which == 1) b1 -= 1;
    else if (which == 2) b2 -= 1;
    else if (which == 3) b1 = 1 - b1, b2 = 1 - b2;
    code = 4 * code + which;
  }
  return code;
}

/// Means over a part of the largest channel of the shares of its pieces.
struct Pieces {
  Rgbd share;
  double mean = 0, square = 0;
};

class Divider {
 public:
  /// `whole`: share of the whole triangle.
  Divider(const SceneFrame& frame, std::uint32_t surface, Rgb whole, double uneven)
      : frame_(frame), surface_(surface), whole_(whole), uneven_(uneven) {}

  /// Appends the parts of a part that may be cut `cuts` times more.
  Pieces divide(const EmissionPart& whole, int cuts, int cuts_below_finest, std::vector<EmissionPart>& parts) const {
    const std::size_t first = parts.size();
    if (cuts == 0) {
      parts.push_back(whole);
      const Rgb share = parts.back().share = mean_emission_share(frame_, surface_, whole.triangle, whole.where, whole_);
      const double most = max_component(share);
      return {Rgbd(share), most, most * most};
    }
    Pieces sum;
    for (int which = 0; which < 4; ++which) {
      EmissionPart part = whole;
      part.where = quarter(whole.where, which);
      part.code += std::uint32_t(which) << (2 * (cuts_below_finest - 1));
      const Pieces of = divide(part, cuts - 1, cuts_below_finest - 1, parts);
      sum.share += of.share * 0.25;
      sum.mean += of.mean * 0.25;
      sum.square += of.square * 0.25;
    }
    if (sum.square <= (1 + uneven_) * sum.mean * sum.mean) {
      parts.resize(first);
      parts.push_back(whole);
      parts.back().share = Rgb(sum.share);
    }
    return sum;
  }

 private:
  const SceneFrame& frame_;
  std::uint32_t surface_;
  Rgb whole_;
  double uneven_;
};

}  // namespace

EmissionParts::EmissionParts(const SceneFrame& frame, std::uint32_t surface)
    : parts_(frame.surfaces[surface].primitive->triangles.size()),
      vary_(emission_varies(frame.materials[frame.surfaces[surface].material])) {
  for (std::uint32_t t = 0; t < parts_.size(); ++t) parts_[t].triangle = t;
  *this = at(frame, surface);
}

EmissionParts EmissionParts::at(const SceneFrame& frame, std::uint32_t surface) const {
  EmissionParts result = *this;
  const Material& material = frame.materials[frame.surfaces[surface].material];
  result.alpha_ = material.alpha, result.alpha_cutoff_ = material.alpha_cutoff;
  result.vary_ = emission_varies(material);
  if (!vary_ && !result.vary_) return result;
  const std::uint32_t triangles = first_.empty() ? std::uint32_t(parts_.size()) : std::uint32_t(first_.size() - 1);
  parallel_each(triangles, 1024, [&](std::size_t index) {
    const auto t = std::uint32_t(index);
    const Rgb whole = mean_emission_share(frame, surface, t);
    for (std::uint32_t i = first(t); i < first(t + 1); ++i)
      result.parts_[i].share =
          parts_[i].where.size == 1 ? whole : mean_emission_share(frame, surface, t, parts_[i].where, whole);
  });
  return result;
}

bool EmissionParts::hold_at(const SceneFrame& frame, std::uint32_t surface) const {
  const Material& material = frame.materials[frame.surfaces[surface].material];
  return alpha_ == material.alpha && alpha_cutoff_ == material.alpha_cutoff;
}

void EmissionParts::divide(const SceneFrame& frame, std::uint32_t surface, std::span<const double> most_of) {
  std::vector<std::vector<EmissionPart>> divided(parts_.size());
  parallel_each(parts_.size(), 16, [&](std::size_t t) {
    const double most = std::min(most_of[t], std::pow(double(emission_texels(frame, surface, std::uint32_t(t))), 2));
    int cuts = 0;
    while (cuts < kMostCuts && std::ldexp(1.0, 2 * (cuts + 1)) <= most) ++cuts;
    if (cuts > 0 && max_component(parts_[t].share) > 0)
      Divider(frame, surface, parts_[t].share, kUneven).divide(parts_[t], cuts, kMostCuts, divided[t]);
    // The mean over a whole triangle is read by more pieces than the mean of its parts.
    if (divided[t].size() < 2) divided[t] = {parts_[t]};
  });
  parts_.clear();
  for (const std::vector<EmissionPart>& parts : divided) {
    first_.push_back(std::uint32_t(parts_.size()));
    parts_.insert(parts_.end(), parts.begin(), parts.end());
  }
  first_.push_back(std::uint32_t(parts_.size()));
}

std::uint32_t EmissionParts::index(std::uint32_t triangle, double b1, double b2) const {
  if (first_.empty()) return triangle;
  const auto begin = parts_.begin() + first_[triangle], end = parts_.begin() + first_[triangle + 1];
  const auto after = std::upper_bound(begin, end, code_at(b1, b2),
                                      [](std::uint32_t code, const EmissionPart& part) { return code < part.code; });
  return std::uint32_t(after - parts_.begin()) - 1;
}

}  // namespace tempolux
