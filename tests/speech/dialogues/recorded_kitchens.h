// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "memory/memory.h"

namespace engram::speech {

/// The recording of seed 1, 60 s, without images: made once for all tests of the process.
Memory& kitchen_of_seed_1();

/// One store with 25 s of seed 2 on January 1, of seed 3 on January 2, and of seed 4 on January 3,
/// each at nine in the morning.
Memory& three_days();

/// 5 s of seed 1, with colours of things.
Memory& coloured_kitchen();

}  // namespace engram::speech
