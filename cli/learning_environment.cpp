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

/// Whether the arguments name a command that runs networks for a long time.
bool is_learning(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (const std::string_view word = argv[i]; word == "consolidate" || word == "eval" ||
                                               word == "crossval" || word == "predict" ||
                                               word == "learn-answers" || word == "learn-sights")
      return true;
  return false;
}

}  // namespace

bool set_learning_environment(int argc, char** argv) {
  const bool has_policy = is_set("OMP_WAIT_POLICY") || is_set("GOMP_SPINCOUNT");
  if (!has_policy) ::setenv("OMP_WAIT_POLICY", "passive", 1);
  const bool has_memory = is_set("GLIBC_TUNABLES") || !is_learning(argc, argv);
  if (!has_memory) ::setenv("GLIBC_TUNABLES", kMemory, 1);
  return !has_policy || !has_memory;
}

void prepare_to_learn(int argc, char** argv) {
  if (set_learning_environment(argc, argv)) ::execv("/proc/self/exe", argv);
  // If it fails, the program is slower but correct.
}

}  // namespace engram::cli
