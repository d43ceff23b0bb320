#include "lib/gather/hemisphere.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tempolux {
namespace {

/// Integral of tan over a ring's share of the projected hemisphere: asin sqrt s - sqrt(s (1 - s)).
double ring_integral(double s) { return std::asin(std::sqrt(s)) - std::sqrt(s * (1 - s)); }

}  // namespace

void gather_strata(int rays, int& rings, int& sectors) {
  rings = std::max(1, int(std::lround(std::sqrt(double(rays) / M_PI))));
  sectors = std::max(3, int(std::lround(double(rays) / rings)));
}

void Hemisphere::reset(int rings, int sectors) {
  if (rings != rings_) {
    ring_tangent_.resize(std::size_t(rings));
    for (int j = 0; j < rings; ++j)
      ring_tangent_[std::size_t(j)] = rings * (ring_integral(double(j + 1) / rings) - ring_integral(double(j) / rings));
  }
  rings_ = rings;
  sectors_ = sectors;
  radiance.assign(std::size_t(rings) * std::size_t(sectors), Rgb(0.0f));
  inverse_distance.assign(radiance.size(), 0.0f);
}

void Hemisphere::irradiance_and_gradients(const Frame& frame, IrradianceRecord& record) const {
  const int M = rings_, N = sectors_;
  Rgbd sum{0.0};
  std::array<Vec3d, 3> rotational{}, translational{};
  for (int k = 0; k < N; ++k) {
    const double middle = 2 * M_PI * (k + 0.5) / N, lower = 2 * M_PI * double(k) / N;
    const Vec3d u{std::cos(middle), std::sin(middle), 0}, v{-std::sin(middle), std::cos(middle), 0};
    const Vec3d v_lower{-std::sin(lower), std::cos(lower), 0};
    Rgbd turn{0.0}, along{0.0}, across{0.0};
    for (int j = 0; j < M; ++j) {
      const Rgbd here(radiance[cell(j, k)]);
      const double near_here = double(inverse_distance[cell(j, k)]);
      sum += here;
      turn += here * ring_tangent_[std::size_t(j)];
      const double s_lower = std::sqrt(double(j) / M), s_upper = std::sqrt(double(j + 1) / M);
      if (j > 0) {
        const double near = std::max(near_here, double(inverse_distance[cell(j - 1, k)]));
        along += (here - Rgbd(radiance[cell(j - 1, k)])) * (s_lower * (1 - s_lower * s_lower) * near);
      }
      const std::size_t before = cell(j, (k + N - 1) % N);
      const double near = std::max(near_here, double(inverse_distance[before]));
      across += (here - Rgbd(radiance[before])) * ((s_upper - s_lower) * near);
    }
    for (int c = 0; c < 3; ++c) {
      rotational[std::size_t(c)] += v * (turn[c] * M_PI / (double(M) * N));
      translational[std::size_t(c)] += u * (along[c] * 2 * M_PI / N) + v_lower * across[c];
    }
  }
  record.irradiance = Rgb(sum * (M_PI / (double(M) * N)));
  for (std::size_t c = 0; c < 3; ++c) {
    record.rotational[c] = frame.to_world(Vec3(rotational[c]));
    record.translational[c] = frame.to_world(Vec3(translational[c]));
  }
}

float Hemisphere::curvature() const {
  const int M = rings_, N = sectors_;
  Rgbd xx{0.0}, xy{0.0}, yy{0.0};
  for (int k = 0; k < N; ++k) {
    const double middle = 2 * M_PI * (k + 0.5) / N, lower = 2 * M_PI * double(k) / N;
    Rgbd along{0.0}, mixed{0.0};
    for (int j = 0; j < M; ++j) {
      const Rgbd here(radiance[cell(j, k)]);
      const double near_here = double(inverse_distance[cell(j, k)]);
      if (j > 0) {
        const double near = std::max(near_here, double(inverse_distance[cell(j - 1, k)])), sin2 = double(j) / M;
        along += (here - Rgbd(radiance[cell(j - 1, k)])) * ((1 - sin2) * (4 * sin2 - 1) * near * near);
      }
      const std::size_t before = cell(j, (k + N - 1) % N);
      const double near = std::max(near_here, double(inverse_distance[before]));
      mixed += (here - Rgbd(radiance[before])) * (1.5 / M * near * near);
    }
    along *= 2 * M_PI / N;
    const double cu = std::cos(middle), su = std::sin(middle), cl = std::cos(lower), sl = std::sin(lower);
    xx += along * (cu * cu) - mixed * (2 * cl * sl);   // u v + v u, u = (c, s), v = (-s, c)
    yy += along * (su * su) + mixed * (2 * cl * sl);
    xy += along * (cu * su) + mixed * (cl * cl - sl * sl);
  }
  double size = 0;
  for (int c = 0; c < 3; ++c) {
    const double mean = (xx[c] + yy[c]) / 2, apart = std::hypot((xx[c] - yy[c]) / 2, xy[c]);
    size += std::max(std::abs(mean), apart);   // (|mean + apart| + |mean - apart|) / 2
  }
  return float(size);
}

float Hemisphere::lit_cells() const {
  double sum = 0, square = 0;
  for (const Rgb& l : radiance) {
    const double value = double(l.r) + double(l.g) + double(l.b);
    sum += value;
    square += value * value;
  }
  return square > 0 ? float(sum * sum / square) : 0.0f;
}

float Hemisphere::harmonic_distance() const {
  double sum = 0, hits = 0;
  for (const float inverse : inverse_distance) {
    sum += double(inverse);
    hits += inverse > 0;
  }
  return sum > 0 ? float(hits / sum) : INFINITY;
}

float Hemisphere::nearest_across() const {
  float nearest = 0;
  for (int k = 0; k < sectors_; ++k) nearest = std::max(nearest, inverse_distance[cell(rings_ - 1, k)]);
  return nearest > 0 ? 1 / nearest : INFINITY;
}

}  // namespace tempolux
