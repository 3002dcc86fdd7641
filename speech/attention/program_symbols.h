// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "speech/attention/asked_names.h"
#include "speech/language/time_words.h"
#include "speech/program/program.h"

namespace engram::speech {

/// The words of the network's language, in their order. A model file names them, and is refused
/// where they are others.
///
/// Names and times are pointers into the question: "thing:1" is the second thing that it names,
/// "during:during" the span of time that it tells. So what was never seen in training can be said.
[[nodiscard]] const std::vector<std::string>& program_symbols();

inline constexpr int32_t kEndSymbol = 0;
inline constexpr int32_t kBeginSymbol = 1;
inline constexpr int32_t kRefusalSymbol = 2;  ///< Alone: nothing of the memory answers it.

/// A program as symbols: source, filters, steps, link, and the same of the program within it;
/// without kBeginSymbol and with kEndSymbol. Nothing: the language of symbols has not got it, or
/// it has a name or a time that the question does not have.
[[nodiscard]] std::optional<std::vector<int32_t>> symbols_of(const Program& program,
                                                             const AskedNames& names,
                                                             const AskedTimes& times);

/// What the symbols tell, up to kEndSymbol. Nothing: it makes no sense, points at nothing, or does
/// not validate.
[[nodiscard]] std::optional<Program> program_told(const std::vector<int32_t>& symbols,
                                                  const AskedNames& names, const AskedTimes& times);

/// The place among the symbols at which the program within begins: the link's. Nothing: there is
/// none.
[[nodiscard]] std::optional<size_t> link_place(const std::vector<int32_t>& symbols);

/// The program within a program; null: there is none.
[[nodiscard]] const Program* program_within(const Program& program);

}  // namespace engram::speech
