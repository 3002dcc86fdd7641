// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace engram {

/// A renamed word of users: a key of a configuration file or an option of a command. The old word
/// is accepted for two minor versions.
struct DeprecatedWord {
  std::string_view old_word;
  std::string_view word;     ///< The new word.
  std::string_view gone_in;  ///< The first version without the old word, for example "0.3".
};

/// Logs a warning that names both words and the version, once per process and place. `where` is the
/// place as users see it: "servers[0].working_memory.least", "recover --output".
/// Threading: thread-safe.
void warn_deprecated(const DeprecatedWord& word, std::string_view where);

}  // namespace engram
