// lib/volume/majorants_file.h -- reads and writes frozen majorants: formats/majorants/majorants.md.
#pragma once

#include <string>

#include "lib/volume/majorants.h"

namespace tempolux {

/// Majorants and the frames for which they are valid.
struct FrozenMajorants {
  int first_frame = 0, last_frame = 0;
  MajorantGrid grid;  ///< world space
};

/// Text of the file; numbers read back to the bit.
std::string majorants_text(const FrozenMajorants& majorants);
/// Throws InputError "FILE: line N: what; remedy".
FrozenMajorants load_majorants(const std::string& path);

/// Shifts the box by -origin: from world to scene space.
MajorantGrid moved(const MajorantGrid& world, Vec3d origin);

}  // namespace tempolux
