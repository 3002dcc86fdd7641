// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "ltm/core/progress.h"
#include "memory/memory.h"
#include "speech/attention/attention_reader.h"
#include "speech/dialogues/make_dialogues.h"

namespace engram::speech {

/// A question as it is read later, to measure with.
struct AttentionTrial {
  AttendedQuestion asked;
  std::optional<Program> program;  ///< As symbols tell it; nothing: it cannot be answered.
};

/// A question as numbers, with the program that answers it rightly.
struct AttentionExample {
  std::vector<AttentionInput::Word> words;
  /// Traits in 64ths, which take a quarter of the space.
  std::vector<std::array<uint8_t, AttentionInput::kTraits>> groups;
  std::vector<uint32_t> attended;
  std::vector<int32_t> symbols;  ///< With kEndSymbol.
  /// For each group: 1 if the program keeps it, 0 if not, 2 if it is of another source.
  std::vector<uint8_t> main;
  std::vector<uint8_t> other;  ///< Of the program within; empty: there is none.
  /// Its wording, a name or the recording is held out: it is measured with, and nothing is learned
  /// from it. Null: it is learned from.
  std::shared_ptr<const AttentionTrial> trial{};
  bool is_new_wording = false;  ///< Of a trial: its wording is held out.
};

/// Turns a float that is no trait beyond 0..3.98 to its nearest 64th, and back.
[[nodiscard]] std::array<uint8_t, AttentionInput::kTraits> packed(
    const AttentionInput::Traits& traits);
[[nodiscard]] AttentionInput::Traits unpacked(
    const std::array<uint8_t, AttentionInput::kTraits>& traits);

/// What became of dialogues.
struct ExampleCounts {
  size_t dialogues = 0;
  size_t refusals = 0;  ///< Examples of what cannot be answered.
  size_t programs = 0;  ///< Examples with a program.
  size_t unread = 0;    ///< The grammar does not read, or not rightly, what is asked in own words.
  size_t unlike = 0;    ///< What the symbols tell of the program has another answer.

  ExampleCounts& operator+=(const ExampleCounts& other) {
    dialogues += other.dialogues;
    refusals += other.refusals;
    programs += other.programs;
    unread += other.unread;
    unlike += other.unlike;
    return *this;
  }
};

/// Where examples come from, beside a memory.
struct ExampleOptions {
  DialogueOptions dialogues;  ///< `count` is that of the own wordings.
  /// Whether the wordings that come with Engram are asked (docs/dialogues.md): each line once of
  /// each memory.
  bool has_written = true;
  std::vector<std::filesystem::path> wordings{};  ///< More files of such lines.
};

/// Makes dialogues of a memory, and examples of these. The program is that of the grammar for a
/// plain wording of the same question; it counts only if its answer is the true one, and so is that
/// of the program that symbols tell. Of what is held out one in eight is kept, to measure with.
/// Errors: those of make_dialogues; kUnavailable if a file cannot be read.
Result<ExampleCounts> add_examples(Memory& memory, const ExampleOptions& options,
                                   const std::stop_token& stop,
                                   std::vector<AttentionExample>& examples);

}  // namespace engram::speech
