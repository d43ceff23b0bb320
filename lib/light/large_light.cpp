#include "lib/light/large_light.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/sampling.h"

namespace tempolux {
namespace {

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

/// The same of four at a time, bit for bit.
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

/// Where on the rectangle, in its sides' lengths; solid_angle: 0 if it is too small or too near to go by it.
Vec2 sample_spherical_rectangle(const LargeLight& light, Vec3 from, float z, Vec2 u, float& solid_angle) {
  const Vec3 side_x = light.corner[1] - light.corner[0], side_y = light.corner[3] - light.corner[0], to = light.corner[0] - from;
  const float width = length(side_x), height = length(side_y);
  const float x0 = dot(to, side_x) / width, x1 = x0 + width, y0 = dot(to, side_y) / height, y1 = y0 + height;
  // Planes through the point and the sides y0, x1, y1, x0, normals inwards: z components alone are needed of two.
  const __m128 side = _mm_setr_ps(-y0, x1, y1, -x0), one = _mm_set1_ps(1);
  const __m128 b = side * (one / _mm_sqrt_ps(_mm_set1_ps(z * z) + side * side));
  const __m128 cosine = _mm_setzero_ps() - b * _mm_shuffle_ps(b, b, _MM_SHUFFLE(0, 3, 2, 1));   // of the angles at the corners
  alignas(16) float angle[4], bs[4];
  _mm_store_ps(angle, angles_of(_mm_sqrt_ps(_mm_max_ps(_mm_setzero_ps(), one - cosine * cosine)), cosine));
  _mm_store_ps(bs, b);
  const float b0 = bs[0], b2 = bs[2], k = 2 * kPi - angle[2] - angle[3];
  solid_angle = angle[0] + angle[1] - k;
  if (!(solid_angle > kSmallSolidAngle)) {
    solid_angle = 0;
    return u;
  }
  const float along = u.x * solid_angle + k, sine = std::sin(along);
  const float f = sine != 0 ? (std::cos(along) * b0 - b2) / sine : INFINITY;
  const float cu = std::clamp(std::copysign(1 / std::sqrt(f * f + b0 * b0), f), -1.0f, 1.0f);
  const float x = std::clamp(cu * z / std::sqrt(std::max(1e-12f, 1 - cu * cu)), x0, x1);
  const float d2 = x * x + z * z, h0 = y0 / std::sqrt(d2 + y0 * y0), h1 = y1 / std::sqrt(d2 + y1 * y1);
  const float h = h0 + u.y * (h1 - h0);
  const float y = std::clamp(h * std::sqrt(d2 / std::max(1e-12f, 1 - h * h)), y0, y1);
  return {(x - x0) / width, (y - y0) / height};
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

bool sample_large_light(const LargeLight& light, Vec3 from, Vec2 u, LargeLightPoint& sample) {
  if (!light.is_rectangle()) {
    TrianglePoint point;
    if (!sample_triangle(light.triangle, from, u, point)) return false;
    sample = {point.position, point.wi, point.pdf_solid_angle};
    return true;
  }
  const float height = height_above(light, from);
  if (!(height > 0)) return false;
  float solid_angle = 0;
  const Vec2 at = sample_spherical_rectangle(light, from, height, u, solid_angle);
  sample.position = light.corner[0] + (light.corner[1] - light.corner[0]) * at.x + (light.corner[3] - light.corner[0]) * at.y;
  const Vec3 to = sample.position - from;
  const double distance = double(length(to));
  if (!(distance > 0)) return false;
  sample.wi = to / float(distance);
  sample.pdf_solid_angle = solid_angle > 0 ? 1 / double(solid_angle)
                                           : distance * distance * distance / (2 * light.triangle.area * double(height));
  return sample.pdf_solid_angle < INFINITY;
}

}  // namespace tempolux
