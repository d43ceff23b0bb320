#include "lib/gather/hemisphere.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/random.h"

namespace tempolux {
namespace {

/// Integral of tan over a ring's part of the projected hemisphere: asin sqrt s - sqrt(s (1 - s)).
double ring_integral(double s) { return std::asin(std::sqrt(s)) - std::sqrt(s * (1 - s)); }

/// Unit vector in the tangent plane with the azimuth 2 pi k / count.
Vec3d azimuth(double k, double count) {
  const double phi = 2 * M_PI * k / count;
  return {std::cos(phi), std::sin(phi), 0};
}

}  // namespace

void Hemisphere::reset(int rings, int sectors) {
  ring_tangent_.resize(std::size_t(rings));
  for (int j = 0; j < rings; ++j)
    ring_tangent_[std::size_t(j)] = rings * (ring_integral(double(j + 1) / rings) - ring_integral(double(j) / rings));
  rings_ = rings;
  sectors_ = sectors;
  radiance.assign(std::size_t(rings) * std::size_t(sectors), Rgb(0.0f));
  inverse_distance.assign(radiance.size(), 0.0f);
}

IrradianceRecord Hemisphere::record(const SurfacePoint& place, Vec3 normal) const {
  const Frame frame(normal);
  IrradianceRecord record;
  record.position = place.position;
  record.normal = normal;
  record.object = place.object;
  translational_gradient(frame, record);
  irradiance_and_rotational_gradient(frame, record);
  return record;
}

void Hemisphere::irradiance_and_rotational_gradient(const Frame& frame, IrradianceRecord& record) const {
  const int M = rings_, N = sectors_;
  Rgbd sum{0.0};
  std::array<Vec3d, 3> gradient{};
  for (int k = 0; k < N; ++k) {
    const Vec3d u = azimuth(k + 0.5, N);
    Rgbd turn{0.0};
    for (int j = 0; j < M; ++j) {
      const Rgbd here(radiance[cell(j, k)]);
      sum += here;
      turn += here * ring_tangent_[std::size_t(j)];
    }
    const Vec3d v{-u.y, u.x, 0};
    for (int c = 0; c < 3; ++c) gradient[std::size_t(c)] += v * (turn[c] * M_PI / (double(M) * N));
  }
  record.irradiance = Rgb(sum * (M_PI / (double(M) * N)));
  for (std::size_t c = 0; c < 3; ++c) record.rotational[c] = frame.to_world(Vec3(gradient[c]));
}

void Hemisphere::translational_gradient(const Frame& frame, IrradianceRecord& record) const {
  const std::size_t M = std::size_t(rings_), N = std::size_t(sectors_);
  // Sums over rings, by channel and sector.
  thread_local std::vector<double> sums;
  sums.assign(6 * N, 0.0);
  double* const along[3] = {&sums[0], &sums[N], &sums[2 * N]};
  double* const across[3] = {&sums[3 * N], &sums[4 * N], &sums[5 * N]};
  for (std::size_t j = 0; j < M; ++j) {
    const Rgb* const light = &radiance[j * N];
    const float* const inverse = &inverse_distance[j * N];
    const double s_lower = std::sqrt(double(j) / double(M)), s_upper = std::sqrt(double(j + 1) / double(M));
    const double inwards = s_lower * (1 - s_lower * s_lower), wide = s_upper - s_lower;
    for (std::size_t k = 0; k < N; ++k) {
      const std::size_t before = k == 0 ? N - 1 : k - 1;
      const double weight = wide * double(std::max(inverse[k], inverse[before]));
      for (int c = 0; c < 3; ++c) across[c][k] += (double(light[k][c]) - double(light[before][c])) * weight;
    }
    if (j == 0) continue;
    for (std::size_t k = 0; k < N; ++k) {
      const double weight = inwards * double(std::max(inverse[k], (inverse - N)[k]));
      for (int c = 0; c < 3; ++c) along[c][k] += (double(light[k][c]) - double((light - N)[k][c])) * weight;
    }
  }
  std::array<Vec3d, 3> gradient{};
  for (std::size_t k = 0; k < N; ++k) {
    const Vec3d u = azimuth(double(k) + 0.5, double(N)), lower = azimuth(double(k), double(N));
    const Vec3d v_lower{-lower.y, lower.x, 0};
    for (std::size_t c = 0; c < 3; ++c)
      gradient[c] += u * (along[c][k] * 2 * M_PI / double(N)) + v_lower * across[c][k];
  }
  for (std::size_t c = 0; c < 3; ++c) record.translational[c] = frame.to_world(Vec3(gradient[c]));
}

Rgb Hemisphere::noise(std::uint64_t key) const {
  Rgbd sum{0.0};
  for (std::size_t c = 0; c + 1 < radiance.size(); c += 2) {
    const Rgbd difference = Rgbd(radiance[c]) - Rgbd(radiance[c + 1]);
    sum += mix64(key + c) & 1 ? difference : difference * -1.0;
  }
  return Rgb(sum * (M_PI / double(std::max<std::size_t>(1, radiance.size()))));
}

}  // namespace tempolux
