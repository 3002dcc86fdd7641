// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ltm/core/check.h"

/// What a fuzzer gives its bytes to: aborts where the parser breaks a promise. Returns zero.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size);

namespace engram {

inline std::string_view fuzzed_text(const uint8_t* bytes, size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace engram
