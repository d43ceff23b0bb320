// lib/image/foreign_names.h -- translates channel names of other programs' frames (formats/frames/frames.md 7).
#pragma once

#include <string>

#include "lib/image/image.h"

namespace tempolux {

inline constexpr float kNothingDepth = 1e10f;  ///< the depth that Blender writes where there is no surface

/// Our name for a channel of Blender or Nuke; other names stay. VIEW is a view layer's name and may be missing:
/// VIEW.Combined.R -> R (G, B, A); VIEW.Depth.Z, depth.Z, VIEW.Z.Z -> Z; VIEW.Normal.X -> N.X; VIEW.Vector.X .Y ->
/// backward.u .v, VIEW.Vector.Z .W -> forward.u .v. Cycles' Denoising Data: VIEW.Denoising Albedo.R -> albedo.R,
/// Denoising Normal.X -> N.X, Denoising Depth.Z -> Z.
std::string our_name(const std::string& channel);

/// Renames all channels to our names. A channel that has our name already takes precedence. If there are several view
/// layers, the function uses the first by name that has a picture. Depths of kNothingDepth and more become +inf. The
/// sign of Blender's forward motion, which points backward in time, is changed.
void name_as_ours(Image& image);

}  // namespace tempolux
