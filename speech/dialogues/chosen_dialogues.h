// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: from questions without words to dialogues.

#include <vector>

#include "speech/dialogues/make_dialogues.h"
#include "speech/dialogues/phrasings.h"

namespace engram::speech::dialogues {

/// What can be asked at the times that the options say.
[[nodiscard]] std::deque<KnownAnswer> all_known(const LivedPast& past,
                                                const DialogueOptions& options);

/// Puts an answer and its words together; without an ID.
[[nodiscard]] Dialogue dialogue_of(const LivedPast& past, const KnownAnswer& known,
                                   const WordedQuestion& words);

[[nodiscard]] std::vector<Dialogue> chosen_dialogues(const LivedPast& past,
                                                     const DialogueOptions& options);

}  // namespace engram::speech::dialogues
