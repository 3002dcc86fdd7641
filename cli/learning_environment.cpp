// SPDX-License-Identifier: Apache-2.0
#include "cli/learning_environment.h"

#include <stdlib.h>
#include <unistd.h>

#include <string_view>

namespace engram::cli {

namespace {

/// Settings of glibc; other C libraries ignore them.
constexpr const char* kMemory =
    "glibc.malloc.hugetlb=1:glibc.malloc.trim_threshold=1000000000:"
    "glibc.malloc.mmap_threshold=1000000000";

bool is_set(const char* name) {
  return ::getenv(name) != nullptr;
}

}  // namespace

bool is_learning(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (const std::string_view word = argv[i];
        word == "consolidate" || word == "eval" || word == "crossval" || word == "predict")
      return true;
  return false;
}

bool set_learning_environment() {
  const bool has_policy = is_set("OMP_WAIT_POLICY") || is_set("GOMP_SPINCOUNT");
  const bool has_memory = is_set("GLIBC_TUNABLES");
  if (!has_policy) ::setenv("OMP_WAIT_POLICY", "passive", 1);
  if (!has_memory) ::setenv("GLIBC_TUNABLES", kMemory, 1);
  return !has_policy || !has_memory;
}

void prepare_to_learn(char** argv) {
  if (set_learning_environment()) ::execv("/proc/self/exe", argv);
  // If it fails, the program is slower but correct.
}

}  // namespace engram::cli
