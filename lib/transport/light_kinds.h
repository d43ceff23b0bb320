// lib/transport/light_kinds.h -- which kinds of light at a place are known.
#pragma once

#include <cstdint>
#include <initializer_list>

namespace tempolux {

/// Kinds of light that arrives at a place. Each kind counts once: camera paths and gather rays leave out what is known.
enum class LightKind : std::uint8_t {
  direct,    ///< from lights, straight or through panes
  caustic,   ///< from lights by events S
  indirect,  ///< from lights by at least one event D
  bright,    ///< the part of indirect light that comes from bright points and is sampled explicitly (BrightPoints)
  lamps,     ///< from lamps close to surfaces, which records may leave out (KnownLight::lamp_spots)
};

/// A set of kinds of light.
class LightKinds {
 public:
  constexpr LightKinds() = default;
  constexpr LightKinds(std::initializer_list<LightKind> kinds) {
    for (const LightKind kind : kinds) add(kind);
  }
  constexpr bool has(LightKind kind) const { return bits_ >> int(kind) & 1; }
  constexpr void add(LightKind kind) { bits_ = std::uint8_t(bits_ | 1 << int(kind)); }

 private:
  std::uint8_t bits_ = 0;
};

}  // namespace tempolux
