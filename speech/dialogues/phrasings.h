// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how questions are put into words.

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "speech/dialogues/known_answer.h"

namespace engram::speech::dialogues {

/// A template. `{thing}`, `{place}` and so on are replaced by what is asked about, `{do}`, `{did}`,
/// `{done}` and `{doing}` by words for the skill with what it is done to, `{when}` by a span of
/// time.
struct Phrasing {
  std::string_view form;  ///< Which questions it puts into words: form_of().
  std::string_view text;
};

/// All phrasings, those of one form together. What stands in the list stays where it is, because
/// places in the list name phrasings: new ones are added at the end of their form.
[[nodiscard]] std::span<const Phrasing> object_phrasings();
[[nodiscard]] std::span<const Phrasing> event_phrasings();
[[nodiscard]] std::span<const Phrasing> reason_phrasings();
[[nodiscard]] std::span<const Phrasing> detail_phrasings();
[[nodiscard]] std::span<const Phrasing> moment_phrasings();
[[nodiscard]] std::span<const Phrasing> problem_phrasings();
[[nodiscard]] std::span<const Phrasing> unknown_phrasings();
[[nodiscard]] std::span<const Phrasing> instead_phrasings();

/// The form of a question: what is asked, and what its words must say: "how_often:success".
[[nodiscard]] std::string form_of(const Asked& asked);

/// Words for a skill with what it is done to.
struct VerbPhrase {
  std::string id;     ///< "pick.2"
  std::string base;   ///< "take the salt"
  std::string past;   ///< "took the salt"
  std::string done;   ///< "taken the salt"
  std::string doing;  ///< "taking the salt"
};

/// Each way to say it; empty: nobody says it.
[[nodiscard]] std::vector<VerbPhrase> verb_phrases(const Asked& asked);

struct WordedQuestion {
  std::string text;
  std::string phrasing;  ///< "how_often#2/pick.1"
};

/// All ways to put a question into words, in a fixed order.
[[nodiscard]] std::vector<WordedQuestion> worded(const KnownAnswer& known);

/// All ways to fill one template, which is called `id`: one for each way to say the skill, where it
/// has words for one. Empty: it has a slot that the question does not fill, or lacks one that the
/// question is about.
[[nodiscard]] std::vector<WordedQuestion> worded_by(std::string_view text, const std::string& id,
                                                    const KnownAnswer& known);

/// Whether there are own phrasings of this form.
[[nodiscard]] bool is_form(std::string_view form);

/// Whether another thing is asked with "first" or "last" than without, so that the words must say
/// it.
[[nodiscard]] bool is_choosing(std::string_view what);

struct FilledText {
  std::string text;
  std::set<std::string, std::less<>> slots;  ///< Those that it had.
};

/// The text with all slots filled, whatever else the question is about; nothing if it has a slot
/// that the question does not fill.
[[nodiscard]] std::optional<FilledText> filled_slots(std::string_view text,
                                                     const KnownAnswer& known,
                                                     const VerbPhrase& verb);

}  // namespace engram::speech::dialogues
