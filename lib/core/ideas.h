// lib/core/ideas.h -- ideas that bring speed and can be left out, to measure what each is worth.
//
// tests/bench/ablation.py (`make -f Makefile.example ablation`) writes another name at kLeftOut in a copy of the tree and
// compares CPU seconds x squared error over all scenes. An idea that is worth less than 1.15 in the median and 2 in every kind
// of scene is to be deleted, with its line here. Left out, pictures stay as right as with it, or as the line says.
#pragma once

namespace tempolux {

enum class Idea {
  none,
  shadow_edges,   ///< points beside an edge of a shadow: hits sample direct light themselves; without: light creeps into shadows
  near_hits,      ///< gather rays that hit something near go on; without: they read its point, which is blurred in corners
  further_rays,   ///< a record's rays: more where its first ones found uneven light; without: one for each cell
  light_tree      ///< lights chosen by distance and direction as well; without: by their power alone
};

inline constexpr Idea kLeftOut = Idea::none;

/// Is it in this build? Known to the compiler: what is left out costs nothing, nor does asking.
constexpr bool used(Idea idea) { return idea != kLeftOut; }

}  // namespace tempolux
