// lib/light/emission_parts.h -- cuts triangles whose emission varies into parts over which it is nearly even.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {

/// A triangle of a surface, or a part of it, that is sampled evenly.
struct EmissionPart {
  std::uint32_t triangle = 0;
  std::uint32_t code = 0;  ///< of the part's first piece of the finest size, see EmissionParts
  TrianglePart where;
  Rgb share{1.0f};  ///< mean of the material's emission that textures and alpha let through
};

/// The parts of a surface's triangles, ordered by triangle; each triangle has at least one part. A triangle is cut into
/// four similar parts by the middles of its edges: parts 0, 1, 2 at its corners, part 3 between them. Each part may be
/// cut again in the same way. The numbers 0 to 3 of the parts that hold a piece, from the largest part to the smallest,
/// are the digits to base four of the piece's code.
class EmissionParts {
 public:
  EmissionParts() = default;
  /// Every triangle is one part.
  EmissionParts(const SceneFrame& frame, std::uint32_t surface);

  /// Cuts each triangle into at most most_of[triangle] parts, none much smaller than a texel. Parts are joined again
  /// where that costs little: sampled evenly by area over a part, chosen by the part's mean, light varies by at most
  /// kUneven of the squared mean more than if every piece had its own density.
  void divide(const SceneFrame& frame, std::uint32_t surface, std::span<const double> most_of);

  /// The same parts with the shares of a frame.
  EmissionParts at(const SceneFrame& frame, std::uint32_t surface) const;
  /// True if a texture or alpha makes the emission vary at the frame of the shares.
  bool vary() const { return vary_; }
  /// True if the shares are also right at this frame. They change only with the material's alpha and its cutoff.
  bool hold_at(const SceneFrame& frame, std::uint32_t surface) const;

  std::span<const EmissionPart> all() const { return parts_; }
  /// Index of the triangle's first part; triangle may be the number of triangles.
  std::uint32_t first(std::uint32_t triangle) const { return first_.empty() ? triangle : first_[triangle]; }
  /// Index of the part at the barycentric coordinates (b1, b2) of a triangle.
  std::uint32_t index(std::uint32_t triangle, double b1, double b2) const;

 private:
  static constexpr double kUneven = 0x1p-4;

  std::vector<EmissionPart> parts_;
  std::vector<std::uint32_t> first_;  ///< by triangle, and their number; empty: every triangle is one part
  float alpha_ = 1, alpha_cutoff_ = 0;
  bool vary_ = false;
};

}  // namespace tempolux
