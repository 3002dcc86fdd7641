// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace engram {

/// Gives freed memory back to the system. The allocator keeps what lies between blocks that are
/// still used: after a training of images of 640 x 480 that was 1.7 of 2.7 GB. It takes some
/// milliseconds, so call it between large pieces of work.
///
/// Threading: thread-safe.
void give_back_memory();

/// The same if more than `bytes` bytes of memory are free. It is quick where they are not, so that
/// it may be called in a loop.
void give_back_memory_above(size_t bytes);

/// Memory of this process that is in RAM and belongs to no file; 0 if that is not known. It takes
/// some microseconds. Unit: bytes.
[[nodiscard]] uint64_t anonymous_ram();

}  // namespace engram
