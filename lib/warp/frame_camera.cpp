#include "lib/warp/frame_camera.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "formats/error.h"

namespace tempolux {
namespace {

/// Converts a row-vector matrix to an affine transform of column vectors.
Affine affine_from(const std::array<double, 16>& m) {
  Affine affine;
  for (std::size_t i = 0; i < 3; ++i) affine.row[i] = {m[i], m[4 + i], m[8 + i]};
  affine.translation = {m[12], m[13], m[14]};
  return affine;
}

/// One column of a row-vector matrix: the linear form of (x, y, z, 1) that gives this component.
struct Form {
  Vec3d factors;
  double shift = 0;
};

Form column(const std::array<double, 16>& m, std::size_t c) { return {{m[c], m[4 + c], m[8 + c]}, m[12 + c]}; }

/// The form of points that `from` transforms first.
Form after(const Form& form, const Affine& from) {
  const Vec3d& f = form.factors;
  return {from.row[0] * f.x + from.row[1] * f.y + from.row[2] * f.z, dot(f, from.translation) + form.shift};
}

}  // namespace

FrameCamera::FrameCamera(const std::array<double, 16>& world_to_camera, const std::array<double, 16>& world_to_ndc,
                         int width, int height)
    : width_(width), height_(height), camera_from_world_(affine_from(world_to_camera)) {
  if (!(std::abs(camera_from_world_.determinant()) > 0)) throw std::invalid_argument("worldToCamera cannot be undone");
  world_from_camera_ = inverse(camera_from_world_);
  const Form x = after(column(world_to_ndc, 0), world_from_camera_);
  const Form y = after(column(world_to_ndc, 1), world_from_camera_);
  Form w = after(column(world_to_ndc, 3), world_from_camera_);
  // w is z (perspective) or a constant (orthographic). Rounding errors in the other terms become exact zeros.
  const double scale = std::max({std::abs(w.factors.x), std::abs(w.factors.y), std::abs(w.factors.z)});
  const bool flat = !(scale > 1e-6 * std::abs(w.shift));
  if (flat) w.factors = {};
  else w.shift = std::abs(w.shift) < 1e-4 * scale ? 0 : w.shift;
  x_ = x.factors * double(width);
  x_shift_ = x.shift * width;
  y_ = y.factors * double(height);
  y_shift_ = y.shift * height;
  w_ = w.factors;
  w_shift_ = w.shift;
  const double depth = flat ? w_shift_ : w_.z + w_shift_;
  const double det = x_.x * y_.y - x_.y * y_.x;
  if (!(std::abs(det) > 0) || !(depth > 0) || !std::isfinite(det) || !std::isfinite(depth))
    throw std::invalid_argument("worldToNDC cannot be undone");
  pixel_width_ = depth / std::sqrt(std::abs(det));
  const auto small = [&](double& value, double of) {
    if (std::abs(value) < 1e-6 * std::abs(of)) value = 0;
  };
  small(w_.x, w_.z);
  small(w_.y, w_.z);
  small(x_.y, x_.x);
  small(y_.x, y_.y);
  axes_apart_ = w_.x == 0 && w_.y == 0 && x_.y == 0 && y_.x == 0;
  per_x_ = 1 / x_.x;
  per_y_ = 1 / y_.y;
}

Vec3d FrameCamera::solve(RasterPoint at, double depth) const {
  // Solves (x . p + x_shift) = at.x (w . p + w_shift), and the same for y, with p.z = depth.
  const double a = x_.x - at.x * w_.x, b = x_.y - at.x * w_.y;
  const double c = y_.x - at.y * w_.x, d = y_.y - at.y * w_.y;
  const double e = at.x * (w_.z * depth + w_shift_) - x_.z * depth - x_shift_;
  const double f = at.y * (w_.z * depth + w_shift_) - y_.z * depth - y_shift_;
  const double det = a * d - b * c;
  return {(d * e - b * f) / det, (a * f - c * e) / det, depth};
}

FrameCamera camera_of(const Image& image, const std::string& name) {
  const auto matrix = [&](const char* attribute) -> const std::array<double, 16>& {
    const auto found = image.matrices.find(attribute);
    if (found == image.matrices.end())
      throw InputError(
          name + ": attribute " + attribute +
          " is missing: where its pixels are in space is not known; write the frame with it, a 4x4 matrix");
    return found->second;
  };
  try {
    return {matrix("worldToCamera"), matrix("worldToNDC"), image.width, image.height};
  } catch (const std::invalid_argument& error) {
    throw InputError(name + ": attribute " + error.what() + "; write the frame with the matrices of its camera");
  }
}

}  // namespace tempolux
