// SPDX-License-Identifier: Apache-2.0
// Programs that are executed on a remembered kitchen.
#pragma once

#include <gmock/gmock.h>

#include <string>

#include "speech/program/execute.h"
#include "tests/speech/known_kitchen.h"

namespace engram::speech::testing {

class Executing : public KnownKitchen {
 protected:
  Outcome outcome_of(const std::string& text) {
    const auto program = Program::parse(text);
    EXPECT_OK(program);
    if (!program.ok()) return {};
    auto outcome = execute(*program, *facts_, now_, DayZone::kUtc);
    EXPECT_OK(outcome);
    return outcome.ok() ? *outcome : Outcome();
  }

  /// The value as JSON, without links; of what is unknown why it is.
  std::string value_of(const std::string& text) {
    const Outcome outcome = outcome_of(text);
    if (is_unknown(outcome.value)) {
      EXPECT_THAT(outcome.evidence, ::testing::IsEmpty()) << text;
      return "unknown: " + outcome.missing;
    }
    EXPECT_THAT(outcome.evidence, ::testing::Not(::testing::IsEmpty())) << text;
    for (const Evidence& evidence : outcome.evidence) EXPECT_OK(facts_->value_at(evidence.id));
    const auto json = to_json(outcome.value);
    return json.contains("value") ? json["value"].dump() : json.dump();
  }

  Time now_ = second(60);
};

}  // namespace engram::speech::testing
