// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/attention_reader.h"

#include <algorithm>

#include "speech/attention/choose_program.h"

namespace engram::speech {

namespace {

/// Whether the words say enough: one that is neither strange nor says nothing, and not too many
/// strange ones. A network reads something in anything.
bool says_enough(const std::vector<TaggedWord>& words) {
  constexpr std::ptrdiff_t kMaxStrange = 5;
  const auto is_telling = [](const TaggedWord& word) {
    return word.tag != WordTag::kUnknown && word.tag != WordTag::kFiller;
  };
  const auto strange = std::count_if(words.begin(), words.end(), [](const TaggedWord& word) {
    return word.tag == WordTag::kUnknown;
  });
  return std::any_of(words.begin(), words.end(), is_telling) && strange <= kMaxStrange;
}

class AttentionReader final : public QuestionReader {
 public:
  explicit AttentionReader(std::unique_ptr<AttentionNetwork> network)
      : network_(std::move(network)) {}

  [[nodiscard]] std::string_view route() const override { return "attention"; }

  Result<std::optional<ReadProgram>> read(const QuestionInWords& question, KnownFacts& facts,
                                          const Lexicon& lexicon, Time now, DayZone zone) override {
    if (!says_enough(question.words)) return std::optional<ReadProgram>();
    const auto asked = attended_question(question, facts, lexicon, now, zone);
    if (asked.status().code() == StatusCode::kInvalidArgument) return std::optional<ReadProgram>();
    ENGRAM_RETURN_IF_ERROR(asked.status());
    ENGRAM_ASSIGN_OR_RETURN(const AttentionScores scores, network_->attend(asked->input));
    auto chosen = choose_program(scores, asked->groups, asked->names, asked->times);
    if (!chosen) return std::optional<ReadProgram>();
    const double confidence = chosen->confidence;
    return std::optional(ReadProgram{std::move(chosen->program), confidence,
                                     confidence >= network_->min_confidence(),
                                     confidence >= network_->sure_confidence()});
  }

 private:
  std::unique_ptr<AttentionNetwork> network_;
};

}  // namespace

Result<AttendedQuestion> attended_question(const QuestionInWords& question, KnownFacts& facts,
                                           const Lexicon& lexicon, Time now, DayZone zone) {
  AttendedQuestion asked{.names = AskedNames(question, lexicon), .times = question.times};
  asked.input.words = numbers_of_words(question, asked.names);
  if (asked.input.words.size() > AttentionInput::kMaxWords)
    return invalid_argument("it has {} words, and at most {} can be attended to",
                            asked.input.words.size(), AttentionInput::kMaxWords);
  ENGRAM_ASSIGN_OR_RETURN(asked.groups, episode_groups(facts, asked.names, asked.times, now, zone));
  for (const EpisodeGroup& group : asked.groups)
    asked.input.groups.push_back(traits_of(group, asked.names, now));
  asked.input.attended = attended_first(asked.groups, asked.names);
  return asked;
}

std::unique_ptr<QuestionReader> make_attention_reader(std::unique_ptr<AttentionNetwork> network) {
  return std::make_unique<AttentionReader>(std::move(network));
}

}  // namespace engram::speech
