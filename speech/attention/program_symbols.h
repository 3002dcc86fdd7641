// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "speech/language/time_words.h"
#include "speech/program/program.h"

namespace engram::speech {

/// How a program within a program stands in it.
enum class ProgramLink { kNone, kAfter, kBefore, kAt, kMoreThan, kLessThan, kEquals };

/// A program without names: what symbols tell. Its filters are times alone.
struct ProgramFrame {
  Program main;
  ProgramLink link = ProgramLink::kNone;
  Program other;  ///< Of the link.
};

/// The words of the network's language, in their order. A model file names them, and is refused
/// where they are others.
[[nodiscard]] const std::vector<std::string>& program_symbols();

inline constexpr int32_t kEndSymbol = 0;
inline constexpr int32_t kBeginSymbol = 1;
inline constexpr int32_t kRefusalSymbol = 2;  ///< Alone: nothing of the memory answers it.

/// A program as symbols: source, times, steps, link, and the same of the program within it; without
/// kBeginSymbol and with kEndSymbol. Its names are left out. `times` are those that the question
/// asks for. Nothing: the language of symbols has not got it.
[[nodiscard]] std::optional<std::vector<int32_t>> symbols_of(const Program& program,
                                                             const AskedTimes& times);

/// What the symbols tell, up to kEndSymbol. `skills` are those of the verbs of the question, joined
/// by commas. Nothing: it makes no sense, or needs a time that the question does not ask for.
[[nodiscard]] std::optional<ProgramFrame> frame_of(const std::vector<int32_t>& symbols,
                                                   const AskedTimes& times,
                                                   const std::string& skills);

/// The place among the symbols at which the program within begins: the link's. Nothing: there is
/// none.
[[nodiscard]] std::optional<size_t> link_place(const std::vector<int32_t>& symbols);

}  // namespace engram::speech
