// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: from questions without words to dialogues.

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "speech/dialogues/make_dialogues.h"
#include "speech/dialogues/phrasings.h"

namespace engram::speech::dialogues {

/// Errors: those of make_dialogues().
Result<LivedPast> read_past(Memory& memory, const DialogueOptions& options);

/// What can be asked at the times that the options say.
[[nodiscard]] std::deque<KnownAnswer> all_known(const LivedPast& past,
                                                const DialogueOptions& options);

/// Questions of one form: those whose answer is no or nothing apart from the others, so that to
/// guess one of both is right in half of them where both can be asked; each by the time at which
/// they are asked, so that no time has more of them because more is known then.
using Alike = std::map<bool, std::map<Time, std::vector<const KnownAnswer*>>>;

/// Whether the answer is "no", "none" or 0.
[[nodiscard]] bool tells_of_nothing(const KnownAnswer& known);

/// Whether a split has this dialogue.
[[nodiscard]] bool is_in(DialogueSplit split, const Dialogue& dialogue);

/// The question in a few own words: up to three.
[[nodiscard]] std::vector<std::string> plain_words(const KnownAnswer& known);

/// Puts an answer and its words together; without an ID.
[[nodiscard]] Dialogue dialogue_of(const LivedPast& past, const KnownAnswer& known,
                                   const WordedQuestion& words);

/// As make_dialogues() tells: families in turn, no question twice.
[[nodiscard]] std::vector<Dialogue> chosen_dialogues(const LivedPast& past,
                                                     const DialogueOptions& options);

}  // namespace engram::speech::dialogues
