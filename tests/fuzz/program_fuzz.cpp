// SPDX-License-Identifier: Apache-2.0
#include "speech/program/program.h"

#include "speech/program/period.h"
#include "tests/fuzz/fuzz_check.h"

/// What reads as a program prints as text and as JSON that read to the same program. The same bytes
/// as a time: it never ends before it begins.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  using namespace engram::speech;
  const auto text = fuzzed_text(bytes, size);
  const Time now = time_from_ns(1'767'254'400'000'000'000);
  const auto period = resolve_period(text, now, DayZone::kUtc);
  if (period.ok()) ENGRAM_CHECK(period->from <= period->to, "{}", text);
  const auto program = Program::parse(text);
  if (!program.ok()) return 0;
  const auto again = Program::parse(program->to_string());
  ENGRAM_CHECK(again.ok() && *again == *program, "{}", program->to_string());
  const auto from_json = Program::from_json(program->to_json());
  ENGRAM_CHECK(from_json.ok() && *from_json == *program, "{}", program->to_json().dump());
  return 0;
}
