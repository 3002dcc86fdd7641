// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::speech {

/// A question and what a memory has to do with it, as numbers that a network attends to. No name of
/// a thing, place or person is in it: of a name there is what it names and which of the question it
/// is, so that names that were never seen in training are as good as others.
///
/// Source: docs/verbalisation.md, section "The route of attention".
struct AttentionInput {
  static constexpr size_t kMaxWords = 60;
  static constexpr size_t kPartsPerWord = 10;
  /// Parts of words are numbers below this; 0 is none.
  static constexpr int32_t kParts = 6144;
  static constexpr size_t kTraits = 36;
  /// Words attend to so many groups at most, those first that have most to do with the question.
  static constexpr size_t kMaxAttended = 24;

  using Word = std::array<int32_t, kPartsPerWord>;
  using Traits = std::array<float, kTraits>;

  std::vector<Word> words;
  /// What the memory has, alike records together: EpisodeGroup.
  std::vector<Traits> groups;
  std::vector<uint32_t> attended;  ///< Indices of groups.
};

/// What a network reads a question as.
struct AttentionScores {
  /// One reading: symbols of a program (program_symbols.h), and which groups it selects.
  struct Reading {
    std::vector<int32_t> symbols;
    double log_probability = 0;
    std::vector<float> main;   ///< A logit for each group: whether the program selects it,
    std::vector<float> other;  ///< and whether the program within it does; empty: there is none.
  };
  std::vector<Reading> readings;  ///< The likeliest first.
};

}  // namespace engram::speech
