// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/free_memory.h"

#include <malloc.h>
#include <unistd.h>

#include <fstream>

namespace engram {

uint64_t anonymous_ram() {
  std::ifstream statm("/proc/self/statm");
  uint64_t size = 0, resident = 0, shared = 0;
  if (!(statm >> size >> resident >> shared) || resident < shared) return 0;
  return (resident - shared) * static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
}

void give_back_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

void give_back_memory_above(size_t bytes) {
#ifdef __GLIBC__
  // What the allocator calls free may have been given back already, so RAM is compared with what is
  // used. Other arenas than the main one are not counted as used, and are small.
  const auto info = ::mallinfo2();
  if (anonymous_ram() > info.uordblks + info.hblkhd + bytes) give_back_memory();
#else
  (void)bytes;
#endif
}

}  // namespace engram
