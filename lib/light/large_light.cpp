#include "lib/light/large_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/sampling.h"
#include "lib/light/lanes.h"

namespace tempolux {
namespace {

static_assert(kLargeTogether == Lanes::kCount);
constexpr double kSameShape = 1e-5;      // of the size
constexpr float kSmallSolidAngle = 0.02f;
constexpr float kFewDigits = 0.05f;      // sr: below, sums over edges cancel too many digits of a float

constexpr std::array kArcTangent{0.0028662257f, -0.0161657367f, 0.0429096138f,  -0.0752896400f, 0.1065626393f,
                                 -0.1420889944f, 0.1999355085f, -0.3333314528f, 1.0f};
/// The angle in [0, pi] of a sine >= 0 and a cosine of any common length. Abramowitz & Stegun 4.4.49, to 2e-8.
inline float angle_of(float sine, float cosine) {
  const float c = std::abs(cosine), small = std::min(sine, c), large = std::max(sine, c);
  const float x = large > 0 ? small / large : 0, x2 = x * x;
  float p = kArcTangent[0];
  for (std::size_t i = 1; i < kArcTangent.size(); ++i) p = p * x2 + kArcTangent[i];
  p *= x;
  const float first = sine > c ? kPi / 2 - p : p;
  return cosine < 0 ? kPi - first : first;
}
inline double angle_of(double sine, double cosine) { return std::atan2(sine, cosine); }

/// The same of eight at a time.
inline Lanes angle_of(Lanes sine, Lanes cosine) {
  const Lanes c = abs(cosine), large = max(sine, c);
  const Lanes x = (large > 0.0f) & (min(sine, c) / large), x2 = x * x;
  Lanes p = kArcTangent[0];
  for (std::size_t i = 1; i < kArcTangent.size(); ++i) p = p * x2 + kArcTangent[i];
  p = p * x;
  const Lanes first = choose(sine > c, p, kPi / 2 - p);
  return choose(cosine, first, kPi - first);   // by its sign
}

/// Of four at a time, bit for bit.
inline __m128 angles_of(__m128 sine, __m128 cosine) {
  const auto all = [](float x) { return _mm_set1_ps(x); };
  const __m128 c = _mm_andnot_ps(all(-0.0f), cosine), large = _mm_max_ps(sine, c);
  const __m128 x = _mm_and_ps(_mm_cmpgt_ps(large, _mm_setzero_ps()), _mm_min_ps(sine, c) / large), x2 = x * x;
  __m128 p = all(kArcTangent[0]);
  for (std::size_t i = 1; i < kArcTangent.size(); ++i) p = p * x2 + all(kArcTangent[i]);
  p *= x;
  const __m128 first = _mm_blendv_ps(p, all(kPi / 2) - p, _mm_cmpgt_ps(sine, c));
  return _mm_blendv_ps(first, all(kPi) - first, cosine);   // by its sign
}

/// Twice the integral of the cosine over a polygon seen from the origin, all of it above the horizon.
template <class T>
T edge_sum(const Vec3T<T>* corner, int count, Vec3T<T> normal) {
  T sum = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3T<T> a = corner[i], b = corner[i + 1 < count ? i + 1 : 0], around = cross(a, b);
    const T sine = length(around);
    if (sine > 0) sum += angle_of(sine, dot(a, b)) / sine * dot(around, normal);
  }
  return std::abs(sum);
}

/// Four corners, in the order of the float form.
float edge_sum(__m128 x, __m128 y, __m128 z, Vec3 normal) {
  const auto next = [](__m128 v) { return _mm_shuffle_ps(v, v, _MM_SHUFFLE(0, 3, 2, 1)); };
  const auto all = [](float f) { return _mm_set1_ps(f); };
  const __m128 x2 = next(x), y2 = next(y), z2 = next(z);
  const __m128 around_x = y * z2 - z * y2, around_y = z * x2 - x * z2, around_z = x * y2 - y * x2;
  const __m128 sine = _mm_sqrt_ps(around_x * around_x + around_y * around_y + around_z * around_z);
  const __m128 along = around_x * all(normal.x) + around_y * all(normal.y) + around_z * all(normal.z);
  const __m128 part = angles_of(sine, x * x2 + y * y2 + z * z2) / sine * along;
  alignas(16) float each[4];
  _mm_store_ps(each, _mm_and_ps(_mm_cmpgt_ps(sine, _mm_setzero_ps()), part));
  return std::abs(each[0] + each[1] + each[2] + each[3]);
}

/// projected() of a rectangle all of which is above the horizon; below 0: it is not.
float projected_rectangle(const LargeLight& light, Vec3 from, Vec3 normal) {
  const auto& c = light.corner;
  const auto all = [](float f) { return _mm_set1_ps(f); };
  const __m128 x = _mm_setr_ps(c[0].x, c[1].x, c[2].x, c[3].x) - all(from.x), y = _mm_setr_ps(c[0].y, c[1].y, c[2].y, c[3].y) - all(from.y),
               z = _mm_setr_ps(c[0].z, c[1].z, c[2].z, c[3].z) - all(from.z);
  const __m128 height = x * all(normal.x) + y * all(normal.y) + z * all(normal.z);
  if (_mm_movemask_ps(_mm_cmplt_ps(height, _mm_setzero_ps()))) return -1;
  return edge_sum(x, y, z, normal) / 2;
}

template <class T>
T projected(const LargeLight& light, Vec3 from, Vec3 up) {
  const Vec3T<T> normal(up);
  std::array<Vec3T<T>, 4> to;
  std::array<T, 4> height;
  T lowest = INFINITY, highest = -INFINITY;
  for (std::size_t i = 0; i < std::size_t(light.corners); ++i) {
    to[i] = Vec3T<T>(light.corner[i] - from);
    height[i] = dot(to[i], normal);
    lowest = std::min(lowest, height[i]);
    highest = std::max(highest, height[i]);
  }
  if (!(highest > 0)) return 0;
  if (lowest >= 0) return edge_sum(to.data(), light.corners, normal) / 2;
  std::array<Vec3T<T>, 8> above;
  int count = 0;
  for (std::size_t i = 0, n = std::size_t(light.corners); i < n; ++i) {
    const std::size_t j = i + 1 < n ? i + 1 : 0;
    if (height[i] > 0) above[std::size_t(count++)] = to[i];
    if ((height[i] > 0) != (height[j] > 0))
      above[std::size_t(count++)] = to[i] + (to[j] - to[i]) * (height[i] / (height[i] - height[j]));
  }
  return count < 3 ? 0 : edge_sum(above.data(), count, normal) / 2;
}

/// Height of the point above the light's plane on an emitting side; not above 0: it shows none there.
float height_above(const LargeLight& light, Vec3 from) {
  const float height = dot(light.triangle.normal, from - light.corner[0]);
  return light.triangle.two_sided ? std::abs(height) : height;
}

struct OnRectangle {
  Lanes x, y;          ///< in its sides' lengths
  Lanes solid_angle;   ///< 0 if it is too small or too near to go by it: then uniform in area
};

/// Sines and cosines of the first `count`; lanes have none.
void sine_cosine(Lanes angle, std::size_t count, Lanes& sine, Lanes& cosine) {
  alignas(32) float a[Lanes::kCount], s[Lanes::kCount] = {}, c[Lanes::kCount] = {};
  angle.store(a);
  for (std::size_t i = 0; i < count; ++i) {
    s[i] = std::sin(a[i]);
    c[i] = std::cos(a[i]);
  }
  sine = Lanes::load(s);
  cosine = Lanes::load(c);
}

/// A point uniform in solid angle, from `count` points z above the plane.
OnRectangle sample_spherical_rectangle(const LargeLight& light, std::size_t count, Vec3T<Lanes> from, Lanes z, Lanes u, Lanes v) {
  const auto all = [](Vec3 a) { return Vec3T<Lanes>{a.x, a.y, a.z}; };
  const Vec3 side_x = light.corner[1] - light.corner[0], side_y = light.corner[3] - light.corner[0];
  const Lanes width = length(side_x), height = length(side_y);
  const Vec3T<Lanes> to = all(light.corner[0]) - from;
  const Lanes x0 = dot(to, all(side_x)) / width, x1 = x0 + width, y0 = dot(to, all(side_y)) / height, y1 = y0 + height;
  // Planes through the point and the sides y0, x1, y1, x0, normals inwards: z components alone are needed of two.
  const Lanes z2 = z * z, side[4] = {-y0, x1, y1, -x0};
  Lanes b[4], angle[4];
  for (int i = 0; i < 4; ++i) b[i] = side[i] * (Lanes(1.0f) / sqrt(z2 + side[i] * side[i]));
  for (int i = 0; i < 4; ++i) {   // at the corners
    const Lanes cosine = -(b[i] * b[(i + 1) % 4]);
    angle[i] = angle_of(sqrt(max(0.0f, Lanes(1.0f) - cosine * cosine)), cosine);
  }
  const Lanes k = Lanes(2 * kPi) - angle[2] - angle[3], solid_angle = angle[0] + angle[1] - k, large = solid_angle > kSmallSolidAngle;
  Lanes sine, cosine;
  sine_cosine(u * solid_angle + k, count, sine, cosine);
  const Lanes f = (cosine * b[0] - b[2]) / sine;   // infinite where the sine is 0
  const Lanes cu = max(min(with_sign_of(Lanes(1.0f) / sqrt(f * f + b[0] * b[0]), f), 1.0f), -1.0f);
  const Lanes least = 1e-12f;
  const Lanes x = min(max(cu * z / sqrt(max(least, Lanes(1.0f) - cu * cu)), x0), x1);
  const Lanes d2 = x * x + z2, h0 = y0 / sqrt(d2 + y0 * y0), h1 = y1 / sqrt(d2 + y1 * y1);
  const Lanes h = h0 + v * (h1 - h0);
  const Lanes y = min(max(h * sqrt(d2 / max(least, Lanes(1.0f) - h * h)), y0), y1);
  return {choose(large, u, (x - x0) / width), choose(large, v, (y - y0) / height), large & solid_angle};
}

/// Completes a triangle to the rectangle of which the other is the other half; false if it is not.
bool join(const TriangleLight& other, LargeLight& light) {
  const TriangleLight& t = light.triangle;
  if (!(other.radiance == t.radiance) || other.two_sided != t.two_sided || !(dot(other.normal, t.normal) > 0.999f)) return false;
  const std::array<Vec3, 3> a{light.corner[0], light.corner[1], light.corner[2]},
      b{other.corner, other.corner + other.edge1, other.corner + other.edge2};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d right(a[i]), p(a[(i + 1) % 3]), q(a[(i + 2) % 3]), fourth = p + q - right;
    const double close = kSameShape * length(q - p);
    if (std::abs(dot(p - right, q - right)) > close * length(q - p)) continue;
    const auto has = [&](Vec3d corner) {
      return std::any_of(b.begin(), b.end(), [&](Vec3 c) { return length(Vec3d(c) - corner) <= close; });
    };
    if (!has(p) || !has(q) || !has(fourth)) continue;
    light.corner = {Vec3(right), Vec3(p), Vec3(fourth), Vec3(q)};
    light.corners = 4;
    return true;
  }
  return false;
}

}  // namespace

LargeLight::LargeLight(const TriangleLight& t) : corner{t.corner, t.corner + t.edge1, t.corner + t.edge2, {}}, triangle(t) {}

std::vector<LargeLight> join_rectangles(const std::vector<TriangleLight>& triangles) {
  std::vector<LargeLight> lights;
  std::vector<bool> joined(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (joined[i]) continue;
    LargeLight& light = lights.emplace_back(triangles[i]);
    for (std::size_t j = i + 1; j < triangles.size() && !light.is_rectangle(); ++j) {
      if (!joined[j] && join(triangles[j], light)) joined[j] = true;
    }
  }
  return lights;
}

double projected_solid_angle(const LargeLight& light, Vec3 from, Vec3 normal) {
  if (!(height_above(light, from) > 0)) return 0;
  float found = light.is_rectangle() ? projected_rectangle(light, from, normal) : -1;
  if (found < 0) found = projected<float>(light, from, normal);
  return found > kFewDigits ? double(found) : projected<double>(light, from, normal);
}

unsigned sample_large_light(const LargeLight& light, std::span<const Vec3> from, std::span<const Vec2> u, LargeLightPoint* samples) {
  TEMPOLUX_CHECK(from.size() <= kLargeTogether && from.size() == u.size());
  unsigned found = 0;
  if (!light.is_rectangle()) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      TrianglePoint point;
      if (!sample_triangle(light.triangle, from[i], u[i], point)) continue;
      samples[i] = {point.position, point.wi, point.pdf_solid_angle};
      found |= 1u << i;
    }
    return found;
  }
  LaneVectors points, numbers;   // u.x, u.y and the height above the light
  for (std::size_t i = 0; i < from.size(); ++i) {
    points.set(int(i), from[i]);
    numbers.set(int(i), {u[i].x, u[i].y, height_above(light, from[i])});
  }
  const Vec3T<Lanes> origin = points.load(), number = numbers.load();
  const OnRectangle at = sample_spherical_rectangle(light, from.size(), origin, number.z, number.x, number.y);
  const auto all = [](Vec3 a) { return Vec3T<Lanes>{a.x, a.y, a.z}; };
  const Vec3T<Lanes> position =
      all(light.corner[0]) + all(light.corner[1] - light.corner[0]) * at.x + all(light.corner[3] - light.corner[0]) * at.y;
  const Vec3T<Lanes> to = position - origin;
  const Lanes distance = sqrt(dot(to, to));
  LaneVectors positions, directions, more;   // more: distance, solid angle
  positions.store(position);
  directions.store(to / distance);
  more.store({distance, at.solid_angle, 0.0f});
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double height = double(numbers.z[i]), d = double(more.x[i]), solid_angle = double(more.y[i]);
    if (!(height > 0) || !(d > 0)) continue;
    const double pdf = solid_angle > 0 ? 1 / solid_angle : d * d * d / (2 * light.triangle.area * height);
    if (!(pdf < INFINITY)) continue;
    samples[i].position = positions.get(int(i));
    samples[i].wi = directions.get(int(i));
    samples[i].pdf_solid_angle = pdf;
    found |= 1u << i;
  }
  return found;
}

}  // namespace tempolux
