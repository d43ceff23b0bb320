// lib/core/vec.h -- three-component vectors and linear Rec. 709 colour triples.
#pragma once

#include <algorithm>
#include <cmath>

namespace tempolux {

template <class T>
struct Vec3T {
  T x{}, y{}, z{};

  constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  bool operator==(const Vec3T&) const = default;
  template <class U>
  constexpr explicit operator Vec3T<U>() const {
    return {U(x), U(y), U(z)};
  }

  constexpr Vec3T operator-() const { return {-x, -y, -z}; }
  constexpr Vec3T& operator+=(Vec3T b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  constexpr Vec3T& operator-=(Vec3T b) {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  constexpr Vec3T& operator*=(T s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
  friend constexpr Vec3T operator+(Vec3T a, Vec3T b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3T operator-(Vec3T a, Vec3T b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3T operator*(Vec3T a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vec3T operator*(T s, Vec3T a) { return a * s; }
  friend constexpr Vec3T operator/(Vec3T a, T s) { return {a.x / s, a.y / s, a.z / s}; }
};

using Vec3 = Vec3T<float>;
using Vec3d = Vec3T<double>;

struct Vec2 {
  float x = 0, y = 0;
  bool operator==(const Vec2&) const = default;
};

template <class T>
constexpr T dot(Vec3T<T> a, Vec3T<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3T<T> cross(Vec3T<T> a, Vec3T<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
constexpr T length2(Vec3T<T> a) {
  return dot(a, a);
}
template <class T>
T length(Vec3T<T> a) {
  return std::sqrt(dot(a, a));
}
/// Unit vector; the zero vector stays zero.
template <class T>
Vec3T<T> normalize(Vec3T<T> a) {
  const T l = length(a);
  return l > 0 ? a / l : Vec3T<T>{};
}
template <class T>
constexpr Vec3T<T> min(Vec3T<T> a, Vec3T<T> b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <class T>
constexpr Vec3T<T> max(Vec3T<T> a, Vec3T<T> b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
template <class T>
constexpr T max_component(Vec3T<T> a) {
  return std::max({a.x, a.y, a.z});
}
template <class T>
Vec3T<T> abs(Vec3T<T> a) {
  return {std::abs(a.x), std::abs(a.y), std::abs(a.z)};
}
template <class T>
bool is_finite(Vec3T<T> a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// A linear Rec. 709 triple of any quantity (flux, radiance, reflectance ...); its declaration gives the unit.
template <class T>
struct RgbT {
  T r{}, g{}, b{};

  constexpr RgbT() = default;
  constexpr explicit RgbT(T grey) : r(grey), g(grey), b(grey) {}
  constexpr RgbT(T r_, T g_, T b_) : r(r_), g(g_), b(b_) {}
  template <class U>
  constexpr explicit operator RgbT<U>() const {
    return {U(r), U(g), U(b)};
  }
  constexpr T operator[](int i) const { return i == 0 ? r : i == 1 ? g : b; }
  constexpr T& operator[](int i) { return i == 0 ? r : i == 1 ? g : b; }
  bool operator==(const RgbT&) const = default;

  constexpr RgbT& operator+=(RgbT o) {
    r += o.r;
    g += o.g;
    b += o.b;
    return *this;
  }
  constexpr RgbT& operator*=(RgbT o) {
    r *= o.r;
    g *= o.g;
    b *= o.b;
    return *this;
  }
  constexpr RgbT& operator*=(T s) {
    r *= s;
    g *= s;
    b *= s;
    return *this;
  }
  friend constexpr RgbT operator+(RgbT a, RgbT o) { return {a.r + o.r, a.g + o.g, a.b + o.b}; }
  friend constexpr RgbT operator-(RgbT a, RgbT o) { return {a.r - o.r, a.g - o.g, a.b - o.b}; }
  friend constexpr RgbT operator*(RgbT a, RgbT o) { return {a.r * o.r, a.g * o.g, a.b * o.b}; }
  friend constexpr RgbT operator*(RgbT a, T s) { return {a.r * s, a.g * s, a.b * s}; }
  friend constexpr RgbT operator*(T s, RgbT a) { return a * s; }
  friend constexpr RgbT operator/(RgbT a, T s) { return {a.r / s, a.g / s, a.b / s}; }
};

using Rgb = RgbT<float>;
using Rgbd = RgbT<double>;

template <class T>
constexpr T max_component(RgbT<T> a) {
  return std::max({a.r, a.g, a.b});
}
template <class T>
constexpr T min_component(RgbT<T> a) {
  return std::min({a.r, a.g, a.b});
}
template <class T>
constexpr T channel_sum(RgbT<T> a) {
  return a.r + a.g + a.b;
}
template <class T>
constexpr T channel_mean(RgbT<T> a) {
  return channel_sum(a) / 3;
}
template <class T>
constexpr bool is_black(RgbT<T> a) {
  return a.r == 0 && a.g == 0 && a.b == 0;
}
/// Luminance weights of Rec. 709.
template <class T>
constexpr T luminance(RgbT<T> a) {
  return T(0.2126) * a.r + T(0.7152) * a.g + T(0.0722) * a.b;
}
template <class T>
bool is_finite(RgbT<T> a) {
  return std::isfinite(a.r) && std::isfinite(a.g) && std::isfinite(a.b);
}

/// Axis-aligned box; empty until something is added.
template <class T>
struct Box3T {
  Vec3T<T> lower{T(INFINITY), T(INFINITY), T(INFINITY)};
  Vec3T<T> upper{T(-INFINITY), T(-INFINITY), T(-INFINITY)};
  void add(Vec3T<T> p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  void add(const Box3T& b) {
    lower = min(lower, b.lower);
    upper = max(upper, b.upper);
  }
  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  Vec3T<T> centre() const { return (lower + upper) * T(0.5); }
  T diagonal() const { return empty() ? T(0) : length(upper - lower); }
};
using Box3 = Box3T<float>;
using Box3d = Box3T<double>;

}  // namespace tempolux
