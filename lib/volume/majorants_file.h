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

/// The content of a file; load_majorants() reads the same bits.
std::string majorants_text(const FrozenMajorants& majorants);
/// Reads a file. Throws InputError "FILE: line N: what; remedy" if it is missing or damaged.
FrozenMajorants load_majorants(const std::string& path);

/// The grid in scene space: its box is moved by -origin.
MajorantGrid moved(const MajorantGrid& world, Vec3d origin);

}  // namespace tempolux
