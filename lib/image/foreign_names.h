// lib/image/foreign_names.h -- channels of other programs' frames by the names that ours have (formats/frames/frames.md
// 7).
#pragma once

#include <string>

#include "lib/image/image.h"

namespace tempolux {

/// What our frames call a channel of Blender's or Nuke's; any other name as it is. VIEW is a view layer's name and may
/// be absent: VIEW.Combined.R -> R (G, B, A); VIEW.Depth.Z, depth.Z, VIEW.Z.Z -> Z; VIEW.Normal.X -> N.X; VIEW.Vector.X
/// .Y -> backward.u .v, VIEW.Vector.Z .W -> forward.u .v; of Cycles' Denoising Data VIEW.Denoising Albedo.R ->
/// albedo.R, Denoising Normal.X -> N.X, Denoising Depth.Z -> Z.
std::string our_name(const std::string& channel);

/// Gives channels our names. One that is there under our name already keeps its own, and of several view layers the
/// first by name that has a picture counts. Depths of 1e10 and more, which mean nothing, become +inf; Blender's forward
/// motion, which is counted back, is turned round.
void name_as_ours(Image& image);

}  // namespace tempolux
