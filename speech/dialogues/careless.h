// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: questions as people type them in a hurry.

#include <random>

#include "speech/dialogues/dialogue.h"
#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

/// With the probability `share` writes a question in small letters without marks, or swaps two
/// letters of a long word that is no name, and notes that in its phrasing: "+small" or "+swapped".
void put_carelessly(Dialogue& dialogue, const KnownAnswer& known, double share,
                    std::mt19937_64& random);

}  // namespace engram::speech::dialogues
