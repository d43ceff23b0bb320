#include "lib/light/sky_by_normal.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kInside = 4;  ///< positions along either side of a part at which the cosine is evaluated
/// Least share of a part, over the mean share: also parts below the horizon keep a little
constexpr double kLeastOfMean = 0.05;
/// A bin of normals is about 1/8 wide, so a direction up to 1/16 below the horizon of the bin's middle is above the
/// horizon of some normals.
constexpr double kAroundHorizon = 1.0 / 16;

/// Bins of the octahedral map [Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors",
/// JCGT 3(2), 2014].
std::uint32_t bin_of(Vec3 n) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  float x = n.x / sum, y = n.z / sum;
  if (n.y < 0) {
    const float fold = (1 - std::abs(y)) * (x >= 0 ? 1.0f : -1.0f);
    y = (1 - std::abs(x)) * (y >= 0 ? 1.0f : -1.0f);
    x = fold;
  }
  constexpr auto kSide = float(SkyByNormal::kSide);
  const auto index = [](float v) {
    return std::min(std::uint32_t(std::max(0.0f, (v + 1) * 0.5f * kSide)), SkyByNormal::kSide - 1);
  };
  return index(y) * SkyByNormal::kSide + index(x);
}

Vec3d middle_of(std::uint32_t bin) {
  const auto at = [](std::uint32_t i) { return (i + 0.5) * 2 / SkyByNormal::kSide - 1; };
  double x = at(bin % SkyByNormal::kSide), z = at(bin / SkyByNormal::kSide);
  const double y = 1 - std::abs(x) - std::abs(z);
  if (y < 0) {
    const double fold = (1 - std::abs(z)) * (x >= 0 ? 1 : -1);
    z = (1 - std::abs(x)) * (z >= 0 ? 1 : -1);
    x = fold;
  }
  return normalize(Vec3d{x, y, z});
}

}  // namespace

SkyByNormal::SkyByNormal(const EnvironmentLight& environment) : environment_(environment) {
  std::vector<Vec3> directions(std::size_t(kParts) * kInside * kInside);
  parallel_chunks(kParts, 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t part = first; part < last; ++part)
      for (std::uint32_t i = 0; i < kInside * kInside; ++i) {
        EnvironmentLight::Sample sample;
        const double u1 = double(part / kAcross) + (i / kInside + 0.5) / kInside,
                     u2 = double(part % kAcross) + (i % kInside + 0.5) / kInside;
        if (environment.sample(u1 / kDown, u2 / kAcross, sample))
          directions[part * kInside * kInside + i] = sample.direction;
      }
  });
  ends_.resize(kNormals);
  parallel_chunks(kNormals, 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t bin = first; bin < last; ++bin) {
      const Vec3 normal(middle_of(std::uint32_t(bin)));
      std::array<double, kParts> weight{};
      double sum = 0;
      for (std::uint32_t part = 0; part < kParts; ++part) {
        for (std::uint32_t i = 0; i < kInside * kInside; ++i)
          weight[part] += std::max(0.0, double(dot(directions[part * kInside * kInside + i], normal)) + kAroundHorizon);
        sum += weight[part];
      }
      const double least = sum > 0 ? kLeastOfMean * sum / kParts : 1;
      double all = 0, end = 0;
      for (double& w : weight) all += w += least;
      Ends& ends = ends_[bin];
      for (std::uint32_t part = 0; part < kParts; ++part) ends.end[part] = float((end += weight[part]) / all);
      ends.end[kParts - 1] = 1;
      ends.guide = Guide<32>([&](double u) { return ends.part_for(float(u), {0, kParts - 1}); }, kParts - 1);
    }
  });
}

/// The part, among those given, that u1 falls in.
std::uint32_t SkyByNormal::Ends::part_for(float u1, Guide<32>::Range parts) const {
  return std::uint32_t(std::upper_bound(end.begin() + parts.first, end.begin() + parts.last, u1) - end.begin());
}

bool SkyByNormal::sample(Vec3 normal, double u1, double u2, EnvironmentLight::Sample& sample) const {
  const Ends& ends = ends_[bin_of(normal)];
  const std::uint32_t part = ends.part_for(float(u1), ends.guide.range(u1));
  const double first = part > 0 ? double(ends.end[part - 1]) : 0, share = double(ends.end[part]) - first;
  if (!(share > 0)) return false;
  const double across = std::clamp((u1 - first) / share, 0.0, 1 - 0x1p-53);
  if (!environment_.sample((part / kAcross + across) / kDown, std::min((part % kAcross + u2) / kAcross, 1 - 0x1p-53),
                           sample))
    return false;
  sample.pdf_solid_angle *= share * kParts;
  return sample.pdf_solid_angle > 0;
}

double SkyByNormal::pdf_solid_angle(Vec3 normal, const EnvironmentLight::Place& place, Vec3 direction) const {
  const Vec2 u = environment_.numbers_of(place, direction);
  const std::uint32_t part =
      std::min(std::uint32_t(u.x * kDown), kDown - 1) * kAcross + std::min(std::uint32_t(u.y * kAcross), kAcross - 1);
  const Ends& ends = ends_[bin_of(normal)];
  const double share = double(ends.end[part]) - (part > 0 ? double(ends.end[part - 1]) : 0);
  return share * kParts * environment_.pdf_solid_angle(place, direction);
}

}  // namespace tempolux
