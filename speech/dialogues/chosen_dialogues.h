// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: from questions without words to dialogues.

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

/// Questions of one form: those whose answer is yes apart from those whose answer is no, so that a
/// guess is right in half of them where both can be asked.
using Alike = std::map<std::string, std::vector<const KnownAnswer*>>;

/// "yes", "no", or nothing where the answer is neither.
[[nodiscard]] std::string sort_of(const KnownAnswer& known);

[[nodiscard]] bool is_in(DialogueSplit split, const Dialogue& dialogue);

/// The question in a few own words: up to three.
[[nodiscard]] std::vector<std::string> plain_words(const KnownAnswer& known);

/// Puts an answer and its words together; without an ID.
[[nodiscard]] Dialogue dialogue_of(const LivedPast& past, const KnownAnswer& known,
                                   const WordedQuestion& words);

[[nodiscard]] std::vector<Dialogue> chosen_dialogues(const LivedPast& past,
                                                     const DialogueOptions& options);

}  // namespace engram::speech::dialogues
