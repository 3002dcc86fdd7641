// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "memory/memory.h"
#include "speech/dialogues/dialogue.h"

namespace engram::speech {

/// Which dialogues are made.
enum class DialogueSplit : uint8_t {
  kAll,
  kTrain,    ///< Nothing of them is held out.
  kHeldOut,  ///< Something of them is.
};

struct DialogueOptions {
  /// How many at most; fewer if there is not so much to ask. Empty: 50, or each phrasing of others.
  std::optional<size_t> count{};
  uint64_t seed = 1;  ///< Chooses among all that can be asked.
  DialogueSplit split = DialogueSplit::kAll;
  /// When questions are asked. Empty: at the last moment of the last recording, at two moments
  /// while it goes on, at one of which something is held, and at nine in the morning of the next
  /// day.
  std::optional<Time> now{};
  /// The share of questions that are put carelessly: in small letters without marks, or with two
  /// letters swapped. 0 to 1.
  double careless = 0;
  bool tells_plainly = false;  ///< Fills Dialogue::plain.

  [[nodiscard]] Status validate() const;
};

/// Makes questions with true answers from what recordings of kitchens tell: from the links and
/// outcomes of their values, read one by one. Families take turns. What is ambiguous is not asked;
/// where several answers are right, all are told.
///
/// Equal recordings and options give equal dialogues.
/// Errors: kInvalidArgument if `options` do not validate, if `now` comes before any recording, or
/// if a value is not what a kitchen records; kNotFound if there is no recording of a kitchen; those
/// of Memory::query. Threading: one thread. Source: docs/dialogues.md.
Result<std::vector<Dialogue>> make_dialogues(Memory& memory, const DialogueOptions& options);

/// The same with the words of others: a file of JSON lines {"question", "form", "skill"} or
/// {"question", "asks"}, whose questions have `{thing}`, `{place}`, `{when}` and so on where
/// something is filled in, and which say what is asked by the form of a Dialogue or by members of
/// "asks" (docs/dialogues.md). Each is filled once, or left out if the recordings have nothing that
/// it fits.
/// Errors: also kInvalidArgument if the file has no such lines; kUnavailable if it cannot be read.
Result<std::vector<Dialogue>> make_dialogues_with(Memory& memory, const DialogueOptions& options,
                                                  const std::filesystem::path& phrasings);

/// The same with the thousands of wordings that come with Engram: speech/dialogues/written.
/// Errors: those of make_dialogues.
Result<std::vector<Dialogue>> make_written_dialogues(Memory& memory,
                                                     const DialogueOptions& options);

}  // namespace engram::speech
