// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: questions in the words of others, who wrote what they ask for beside them.

#include <filesystem>
#include <istream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "speech/dialogues/phrasings.h"

namespace engram::speech::dialogues {

/// One line of a file of phrasings: either has a form, or `asks`.
struct ForeignPhrasing {
  std::string question;
  std::string phrasing;  ///< What dialogues call it: "how_often#w3fa9c1d2" or "foreign#12".
  /// As form_of() calls it: the words are a template such as the own ones. Empty: see `asks`.
  std::string form;
  std::string skill;  ///< Which skill the words mean; empty: any that fits.
  std::map<std::string, std::string> asks;

  [[nodiscard]] std::string ask(const char* name) const {
    const auto found = asks.find(name);
    return found == asks.end() ? std::string() : found->second;
  }
  [[nodiscard]] bool is_unanswerable() const { return ask("what") == "unanswerable"; }
};

/// Reads JSON lines; empty ones are passed over.
/// Errors: kInvalidArgument naming the line.
Result<std::vector<ForeignPhrasing>> read_phrasings(std::istream& lines);
/// The same of a file. Errors: also kUnavailable if it cannot be read.
Result<std::vector<ForeignPhrasing>> read_phrasings(const std::filesystem::path& path);

/// The lines of all files of speech/dialogues/written.
[[nodiscard]] std::string_view written_wordings();
/// What they say, read once. Errors: as read_phrasings().
[[nodiscard]] const Result<std::vector<ForeignPhrasing>>& written_phrasings();

/// Whether the words ask for this answer, apart from slots that it may not fill.
[[nodiscard]] bool fits(const ForeignPhrasing& phrasing, const KnownAnswer& known);

/// All ways to fill the words with what is asked; empty: it has not got one of their slots.
[[nodiscard]] std::vector<WordedQuestion> worded_with(const ForeignPhrasing& phrasing,
                                                      const KnownAnswer& known);

}  // namespace engram::speech::dialogues
