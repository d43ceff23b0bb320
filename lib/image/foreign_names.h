// lib/image/foreign_names.h -- translates channel names of other programs' frames (formats/frames/frames.md 7).
#pragma once

#include <string>

#include "lib/image/image.h"

namespace tempolux {

/// Our name for a channel of Blender or Nuke; any other name stays. VIEW is a view layer's name and may be missing:
/// VIEW.Combined.R -> R (G, B, A); VIEW.Depth.Z, depth.Z, VIEW.Z.Z -> Z; VIEW.Normal.X -> N.X; VIEW.Vector.X .Y ->
/// backward.u .v, VIEW.Vector.Z .W -> forward.u .v; of Cycles' Denoising Data VIEW.Denoising Albedo.R -> albedo.R,
/// Denoising Normal.X -> N.X, Denoising Depth.Z -> Z.
std::string our_name(const std::string& channel);

/// Renames all channels. A channel that already has our name has precedence; of several view layers the first by name
/// that has a picture is used. Depths of 1e10 and more, which mean no surface, become +inf; the sign of Blender's
/// forward motion, which points backward in time, is changed.
void name_as_ours(Image& image);

}  // namespace tempolux
