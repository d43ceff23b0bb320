// formats/mask/why.h -- the causes for which a pixel must be traced: the bits of a mask's channel `why` (mask.md 2).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace tempolux::formats {

/// Causes. A pixel's `why` is the sum of its causes; 0: the pixel need not be traced.
enum Why : std::uint32_t {
  why_specular = 1,
  why_occlusion = 2,
  why_slow = 4,
  why_deforming = 8,
  why_changed_light = 16,
  why_border = 32,
  why_edge = 64,
  why_undersampled = 128,
};

struct NamedWhy {
  Why bit;
  std::string_view name;
  std::array<std::uint8_t, 3> color;  ///< sRGB: the colour in tempolux-info's pictures
};

/// All causes in order. A pixel with several causes is counted and drawn by the first of them.
inline constexpr std::array<NamedWhy, 8> kWhys{{
    {why_specular, "specular", {80, 150, 255}},
    {why_occlusion, "occlusion", {230, 50, 50}},
    {why_slow, "slow", {60, 170, 75}},
    {why_deforming, "deforming", {180, 80, 220}},
    {why_changed_light, "changed light", {250, 220, 60}},
    {why_border, "border", {150, 150, 150}},
    {why_edge, "edge", {255, 255, 255}},
    {why_undersampled, "undersampled", {255, 140, 40}},
}};

}  // namespace tempolux::formats
