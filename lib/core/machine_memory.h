// lib/core/machine_memory.h -- how much memory this process may fill.
#pragma once

#include <cstdint>

namespace tempolux {

/// Bytes: the machine's memory, or less where a control group (a container, a batch job) allows less; of versions 1
/// and 2. Swap is not counted. Never 0.
std::uint64_t machine_memory();

}  // namespace tempolux
