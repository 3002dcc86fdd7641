// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace engram::speech::testing {

/// A program, and questions that mean it. They are asked of RememberedKitchen after its first
/// minute.
struct AskedProgram {
  std::string program;
  std::vector<std::string> questions;
};

[[nodiscard]] const std::vector<AskedProgram>& asked_programs();

/// The same in words of people who knew nothing of the grammar.
[[nodiscard]] const std::vector<AskedProgram>& programs_asked_by_others();

/// What must not be answered, whatever the memory has.
[[nodiscard]] const std::vector<std::string>& unanswerable_questions();

}  // namespace engram::speech::testing
