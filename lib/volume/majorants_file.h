// lib/volume/majorants_file.h -- frozen majorants as a file: formats/majorants/majorants.md.
#pragma once

#include <string>

#include "lib/volume/majorants.h"

namespace tempolux {

/// Majorants of a segment and the frames for which they hold.
struct FrozenMajorants {
  int first_frame = 0, last_frame = 0;
  MajorantGrid grid;  ///< world space
};

/// Text of the file: the same numbers come back to the bit.
std::string majorants_text(const FrozenMajorants& majorants);
/// Throws InputError "FILE: line N: what; remedy".
FrozenMajorants load_majorants(const std::string& path);

/// The box moved by -origin: from world to scene space.
MajorantGrid moved(const MajorantGrid& world, Vec3d origin);

}  // namespace tempolux
