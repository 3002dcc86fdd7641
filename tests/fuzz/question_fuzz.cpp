// SPDX-License-Identifier: Apache-2.0
#include "speech/language/english.h"
#include "speech/language/question_phrases.h"
#include "speech/language/time_words.h"
#include "speech/language/words.h"
#include "speech/program/period.h"
#include "tests/fuzz/fuzz_check.h"

/// A question is refused or becomes a bounded number of words that are not empty, whatever it is;
/// the times that are taken out of it are times of programs, or contradict themselves.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  using namespace engram::speech;
  const auto text = fuzzed_text(bytes, size);
  auto split = split_words(text);
  if (!split.ok()) return 0;
  std::vector<QuestionWord> words = *std::move(split);
  ENGRAM_CHECK(!words.empty() && words.size() <= kMaxQuestionWords + 2, "{} words", words.size());
  for (const QuestionWord& word : words) {
    ENGRAM_CHECK(!word.text.empty(), "a word of '{}' is empty", text);
    ENGRAM_CHECK(!lemma_of(word.text).empty(), "'{}' has no lemma", word.text);
  }
  take_endearments(words);
  take_question_tags(words);
  take_politeness(words);
  replace_phrases(words);
  const Time now = time_from_ns(1'767'254'400'000'000'000);
  const AskedTimes times = take_times(words, now, DayZone::kUtc);
  for (const auto* time : {&times.during, &times.at, &times.after, &times.before}) {
    if (!*time) continue;
    const auto period = resolve_period(**time, now, DayZone::kUtc);
    ENGRAM_CHECK(period.ok() || (*time)->find("..") != std::string::npos, "'{}' of '{}'", **time,
                 text);
  }
  return 0;
}
