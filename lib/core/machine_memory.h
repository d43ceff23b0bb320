// lib/core/machine_memory.h -- how much memory this process may fill.
#pragma once

#include <cstdint>

namespace tempolux {

/// Bytes: the machine's memory, or the smaller limit of a control group of version 1 or 2 (a container, a batch job).
/// Without swap. Never 0.
std::uint64_t machine_memory();

}  // namespace tempolux
