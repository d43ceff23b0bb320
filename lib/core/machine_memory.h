// lib/core/machine_memory.h -- how much memory this process may fill.
#pragma once

#include <cstdint>

namespace tempolux {

/// Bytes of memory that this process may fill: the machine's memory without swap, or the limit of a control group of
/// version 1 or 2 (a container, a batch job) if that is smaller. Never 0.
std::uint64_t machine_memory();

}  // namespace tempolux
