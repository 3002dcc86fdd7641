// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/choose_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "speech/attention/attention_reader.h"
#include "speech/attention/program_symbols.h"
#include "speech/language/asker.h"
#include "speech/program/execute.h"
#include "tests/ltm/expect_status.h"
#include "tests/speech/remembered_kitchen.h"

namespace engram::speech {
namespace {

using ::testing::IsEmpty;
using testing::RememberedKitchen;
using testing::second;
using ::testing::SizeIs;

Program program_of(const char* text) {
  auto program = Program::parse(text);
  EXPECT_OK(program);
  return program.ok() ? *program : Program{};
}

TEST(ProgramSymbols, TellProgramsWithoutTheirNames) {
  const AskedTimes times{.during = "yesterday"};
  for (const char* text :
       {"executions | count", "executions during=yesterday | last | events",
        "things | last_seen | where", "executions at=now | events",
        "executions after=(executions | last | ended) | first | when",
        "executions | first | how_long | more_than=(executions | first | how_long)",
        "executions | which=thing", "plans | last | said"}) {
    const auto symbols = symbols_of(program_of(text), times);
    ASSERT_TRUE(symbols) << text;
    EXPECT_EQ(symbols->back(), kEndSymbol);
    const auto frame = frame_of(*symbols, times, "");
    ASSERT_TRUE(frame) << text;
    EXPECT_EQ(frame->main.source, program_of(text).source);
    EXPECT_EQ(frame->link != ProgramLink::kNone, link_place(*symbols).has_value());
  }
}

TEST(ProgramSymbols, AreNotOfTimesThatNobodyAskedFor) {
  EXPECT_FALSE(symbols_of(program_of("executions during=today | count"), {}));
  const auto symbols =
      symbols_of(program_of("executions during=today | count"), {.during = "today"});
  ASSERT_TRUE(symbols);
  EXPECT_FALSE(frame_of(*symbols, {}, ""));
}

TEST(ProgramSymbols, ThatMakeNoSenseAreNoProgram) {
  const auto count = static_cast<int32_t>(program_symbols().size());
  EXPECT_FALSE(frame_of({}, {}, ""));
  EXPECT_FALSE(frame_of({kRefusalSymbol}, {}, ""));
  EXPECT_FALSE(frame_of({count}, {}, ""));
  EXPECT_FALSE(frame_of({-1}, {}, ""));
  // Any row of symbols is read or refused.
  uint32_t random = 1;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<int32_t> symbols;
    for (int k = 0; k < 6; ++k) {
      random = random * 1664525 + 1013904223;
      symbols.push_back(static_cast<int32_t>(random >> 8) % count);
    }
    (void)frame_of(symbols, {.during = "today"}, "pick");
  }
}

/// Says what a test tells it to say.
class ToldNetwork final : public AttentionNetwork {
 public:
  using Tell = std::function<AttentionScores(const AttentionInput&)>;
  explicit ToldNetwork(Tell tell) : tell_(std::move(tell)) {}
  Result<AttentionScores> attend(const AttentionInput& input) override { return tell_(input); }
  [[nodiscard]] double min_confidence() const override { return 0.5; }

 private:
  Tell tell_;
};

class Attention : public ::testing::Test {
 protected:
  void SetUp() override { kitchen_.live_one_minute(); }

  /// What is asked, with a network that reads `program` and selects what that keeps.
  std::optional<AttendedProgram> read(const char* question, const char* program,
                                      double log_probability = -0.1) {
    auto facts = KnownFacts::read(kitchen_.memory());
    EXPECT_OK(facts);
    const Lexicon lexicon(**facts);
    const auto tagger = make_word_tagger();
    const auto asked =
        attended_question(question, **facts, lexicon, *tagger, second(60), DayZone::kUtc);
    EXPECT_OK(asked);
    const Program wanted = program_of(program);
    const auto symbols = symbols_of(wanted, asked->words.times);
    EXPECT_TRUE(symbols);
    AttentionScores scores;
    scores.readings.push_back({*symbols, log_probability, {}, {}});
    for (const EpisodeGroup& group : asked->groups)
      scores.readings[0].main.push_back(keeps(wanted, group, asked->names) ? 5.0F : -5.0F);
    scores.readings[0].other.assign(asked->groups.size(), -5.0F);
    return choose_program(scores, asked->groups, asked->names, asked->words.times);
  }

  RememberedKitchen kitchen_;
};

TEST_F(Attention, FindsTheFiltersOfWhatIsAttendedTo) {
  for (const auto& [question, program] : std::vector<std::pair<const char*, const char*>>{
           {"Any luck with grabbing the salt?",
            "executions skill=pick thing=salt outcome=success | exists"},
           {"List the failures.", "executions outcome=failure | events"},
           {"Contents of the table?", "things place=table | which=thing"}}) {
    const auto read_as = read(question, program);
    ASSERT_TRUE(read_as) << question;
    auto facts = KnownFacts::read(kitchen_.memory());
    ASSERT_OK(facts);
    const auto wanted = execute(program_of(program), **facts, second(60), DayZone::kUtc);
    const auto found = execute(read_as->program, **facts, second(60), DayZone::kUtc);
    ASSERT_OK(wanted);
    ASSERT_OK(found);
    EXPECT_EQ(found->value, wanted->value) << read_as->program.to_string();
    EXPECT_GT(read_as->confidence, 0.5);
  }
}

TEST_F(Attention, SaysAllNamesOfAQuestionOrNothing) {
  // The salt is named, so a program of all failures is about something else.
  const auto failed = read("Trouble with the salt?", "executions outcome=failure | exists");
  ASSERT_TRUE(failed);
  EXPECT_NE(failed->program.find(FilterKey::kThing), nullptr);
  // Where the robot was has nothing to do with salt.
  EXPECT_FALSE(read("Trouble with the salt?", "robot | where"));
}

TEST_F(Attention, IsAskedWhereNoRuleFits) {
  std::string question;
  const auto network = [&](double log_probability) {
    return std::make_unique<ToldNetwork>([=](const AttentionInput& input) {
      AttentionScores scores;
      scores.readings.push_back(
          {*symbols_of(program_of("executions | count"), {}), log_probability, {}, {}});
      scores.readings[0].main.assign(input.groups.size(), 6.0F);
      return scores;
    });
  };
  const auto answer_of = [&](const char* text, double log_probability, AskRoute route) {
    auto asker = Asker::create(kitchen_.memory(),
                               {.reader = make_attention_reader(network(log_probability))});
    EXPECT_OK(asker);
    auto answer = (*asker)->ask(text, second(60), route);
    EXPECT_OK(answer);
    return *std::move(answer);
  };
  constexpr const char* kUnread = "Was it quick?";
  const auto strange = "How about a bustle?";  // Nothing is called so, or it means something else.
  EXPECT_EQ(answer_of(strange, -0.1, AskRoute::kAuto).route, "attention");
  EXPECT_EQ(answer_of(strange, -5, AskRoute::kAuto).route, "program");
  const Answer read = answer_of(kUnread, -0.1, AskRoute::kAuto);
  EXPECT_EQ(read.route, "attention");
  EXPECT_EQ(kind_of(read.value), "count");
  EXPECT_THAT(read.evidence, Not(IsEmpty()));
  // What it is not sure of is not told, and neither is what is known to be no question.
  EXPECT_EQ(answer_of(kUnread, -5, AskRoute::kAuto).route, "none");
  EXPECT_EQ(answer_of(kUnread, -0.1, AskRoute::kProgram).route, "none");
  EXPECT_EQ(answer_of("What will you do tomorrow?", -0.1, AskRoute::kAuto).route, "none");
  EXPECT_EQ(answer_of("Where is the salt?", -0.1, AskRoute::kAuto).route, "program");
  EXPECT_EQ(answer_of("Did you do anything?", -0.1, AskRoute::kReader).route, "attention");
}

TEST_F(Attention, KnowsNoNames) {
  auto facts = KnownFacts::read(kitchen_.memory());
  ASSERT_OK(facts);
  const Lexicon lexicon(**facts);
  const auto tagger = make_word_tagger();
  const auto words_of = [&](const char* question) {
    auto asked = attended_question(question, **facts, lexicon, *tagger, second(60), DayZone::kUtc);
    EXPECT_OK(asked);
    return asked->input.words;
  };
  EXPECT_EQ(words_of("Where is the salt?"), words_of("Where is the tea?"));
  EXPECT_EQ(words_of("Did you take the salt or the tea?"),
            words_of("Did you take the tea or the salt?"));
  EXPECT_NE(words_of("Did you take the salt or the tea?"),
            words_of("Did you take the tea or the tea?"));
  EXPECT_NE(words_of("Where is the salt?"), words_of("When is the salt?"));
}

TEST_F(Attention, GroupsWhatIsAlike) {
  auto facts = KnownFacts::read(kitchen_.memory());
  ASSERT_OK(facts);
  const Lexicon lexicon(**facts);
  const auto tagger = make_word_tagger();
  const auto of_salt = attended_question("Did you pick up the salt?", **facts, lexicon, *tagger,
                                         second(60), DayZone::kUtc);
  ASSERT_OK(of_salt);
  size_t executions = 0;
  for (const EpisodeGroup& group : of_salt->groups)
    if (group.source == ProgramSource::kExecutions) executions += group.count;
  EXPECT_EQ(executions, (*facts)->executions().size());
  EXPECT_LE(of_salt->input.attended.size(), AttentionInput::kMaxAttended);
  // A hundred words are no question.
  std::string many;
  for (int i = 0; i < 100; ++i) many += "salt ";
  EXPECT_FAILS(attended_question(many, **facts, lexicon, *tagger, second(60), DayZone::kUtc),
               StatusCode::kInvalidArgument, "words");
}

}  // namespace
}  // namespace engram::speech
