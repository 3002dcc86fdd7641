// SPDX-License-Identifier: Apache-2.0
#include "cli/learning_environment.h"

#include <stdlib.h>
#include <unistd.h>

namespace engram::cli {

namespace {

/// Some ten microseconds: longer than the gaps within a layer, shorter than a scheduler's slice.
constexpr const char* kSpins = "10000";
/// Other C libraries than glibc ignore it.
constexpr const char* kMemory =
    "glibc.malloc.hugetlb=1:glibc.malloc.trim_threshold=1000000000:"
    "glibc.malloc.mmap_threshold=1000000000";

bool is_set(const char* name) {
  return ::getenv(name) != nullptr;
}

}  // namespace

void prepare_to_learn(char** argv) {
  const bool has_spins = is_set("OMP_WAIT_POLICY") || is_set("GOMP_SPINCOUNT");
  const bool has_memory = is_set("GLIBC_TUNABLES");
  if (has_spins && has_memory) return;
  if (!has_spins) ::setenv("GOMP_SPINCOUNT", kSpins, 1);
  if (!has_memory) ::setenv("GLIBC_TUNABLES", kMemory, 1);
  ::execv("/proc/self/exe", argv);
  // Where that is not possible it is slower, not wrong.
}

}  // namespace engram::cli
