// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::speech {

/// What an answer can be.
namespace answers {

/// The memory does not tell. That there was nothing is known: then names and events are empty.
struct Unknown {
  friend bool operator==(Unknown, Unknown) = default;
};
struct YesNo {
  bool value = false;
  friend bool operator==(YesNo, YesNo) = default;
};
struct Count {
  int64_t value = 0;
  friend bool operator==(Count, Count) = default;
};
struct Moment {
  Time value{};
  friend bool operator==(Moment, Moment) = default;
};
struct Span {
  Time from{};
  Time to{};
  friend bool operator==(Span, Span) = default;
};
struct Seconds {
  double value = 0;
  friend bool operator==(Seconds, Seconds) = default;
};
struct Metres {
  double value = 0;
  friend bool operator==(Metres, Metres) = default;
};
/// Things, places, persons, hands or skills as they are spoken of; sorted, without duplicates.
struct Names {
  std::vector<std::string> value;
  friend bool operator==(const Names&, const Names&) = default;
};
/// The snapshots at which executions started, in the order of time.
struct Events {
  std::vector<ltm::MemoryId> value;
  friend bool operator==(const Events&, const Events&) = default;
};
/// A reason in words, and the instances that it was read from.
struct Reason {
  std::string value;
  std::vector<ltm::MemoryId> links;
  friend bool operator==(const Reason&, const Reason&) = default;
};

}  // namespace answers

/// The typed value of an answer, which can be compared with another one.
using AnswerValue = std::variant<answers::Unknown, answers::YesNo, answers::Count, answers::Moment,
                                 answers::Span, answers::Seconds, answers::Metres, answers::Names,
                                 answers::Events, answers::Reason>;

[[nodiscard]] inline bool is_unknown(const AnswerValue& value) {
  return std::holds_alternative<answers::Unknown>(value);
}

/// The names, sorted and without duplicates.
[[nodiscard]] answers::Names names_of(std::vector<std::string> names);

/// "unknown", "yes_no", "count", "time", "span", "seconds", "metres", "names", "events", "reason".
[[nodiscard]] std::string_view kind_of(const AnswerValue& value);

/// Returns {"kind": "count", "value": 3}; of a span {"kind", "from", "to"}; of a reason also
/// "links".
[[nodiscard]] nlohmann::ordered_json to_json(const AnswerValue& value);

/// Reads what to_json wrote; safe on hostile values.
/// Errors: kInvalidArgument naming the member, what was found and what was needed.
Result<AnswerValue> answer_value_from_json(const nlohmann::ordered_json& json);

}  // namespace engram::speech
