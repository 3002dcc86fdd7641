// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/choose_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "speech/attention/attention_reader.h"
#include "speech/attention/program_symbols.h"
#include "speech/language/asker.h"
#include "speech/program/execute.h"
#include "tests/ltm/expect_status.h"
#include "tests/speech/known_kitchen.h"
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

/// The names of a question about salt, tea, the table and Ada.
class ProgramSymbols : public testing::KnownKitchen {
 protected:
  void SetUp() override {
    KnownKitchen::SetUp();
    lexicon_.emplace(*facts_);
  }
  AskedNames names(const char* question) {
    auto words =
        question_in_words(question, *lexicon_, *make_word_tagger(), second(60), DayZone::kUtc);
    EXPECT_OK(words);
    return AskedNames(*words, *lexicon_);
  }

  std::optional<Lexicon> lexicon_;
};

TEST_F(ProgramSymbols, PointAtTheNamesOfAQuestion) {
  const AskedTimes times{.during = "yesterday"};
  const AskedNames asked = names("Ada, salt, tea, table?");
  for (const char* text :
       {"executions | count", "executions during=yesterday | last | events",
        "things thing=salt | last_seen | where", "executions at=now | events",
        "executions skill=pick thing=tea outcome=failure | last | reason",
        "executions after=(executions skill=place thing=salt | last | ended) | first | when",
        "executions skill=pick thing=salt | first | how_long | more_than=(executions skill=pick "
        "thing=tea | first | how_long)",
        "executions thing=salt,tea speaker=Ada | which=thing", "words text=salt | last | who",
        "executions outcome=stop | last | instead_has=place",
        "things place=table held=yes | exists", "plans | last | said"}) {
    const Program program = program_of(text);
    const auto symbols = symbols_of(program, asked, times);
    ASSERT_TRUE(symbols) << text;
    EXPECT_EQ(symbols->back(), kEndSymbol);
    EXPECT_EQ(program_within(program) != nullptr, link_place(*symbols).has_value());
    const auto told = program_told(*symbols, asked, times);
    ASSERT_TRUE(told) << text;
    EXPECT_EQ(told->to_string(), program.to_string());
  }
  // The same symbols, asked of tea.
  const auto of_salt = symbols_of(program_of("things thing=salt | where"), names("salt"), {});
  ASSERT_TRUE(of_salt);
  EXPECT_EQ(program_told(*of_salt, names("tea"), {})->to_string(), "things thing=tea | where");
}

TEST_F(ProgramSymbols, AreNotOfNamesAndTimesThatNobodyAskedFor) {
  const AskedNames nothing = names("Well?");
  EXPECT_FALSE(symbols_of(program_of("executions during=today | count"), nothing, {}));
  EXPECT_FALSE(symbols_of(program_of("things thing=salt | where"), nothing, {}));
  const AskedTimes today{.during = "today"};
  const auto symbols = symbols_of(program_of("executions during=today | count"), nothing, today);
  ASSERT_TRUE(symbols);
  EXPECT_FALSE(program_told(*symbols, nothing, {}));
}

TEST_F(ProgramSymbols, ThatMakeNoSenseAreNoProgram) {
  const AskedNames asked = names("salt, tea?");
  const auto count = static_cast<int32_t>(program_symbols().size());
  EXPECT_FALSE(program_told({}, asked, {}));
  EXPECT_FALSE(program_told({kRefusalSymbol}, asked, {}));
  EXPECT_FALSE(program_told({count}, asked, {}));
  EXPECT_FALSE(program_told({-1}, asked, {}));
  // Any row of symbols is read as what validates, or not at all.
  uint32_t random = 1;
  for (int i = 0; i < 50'000; ++i) {
    std::vector<int32_t> symbols;
    for (int k = 0; k < 6; ++k) {
      random = random * 1664525 + 1013904223;
      symbols.push_back(static_cast<int32_t>((random >> 8) % static_cast<uint32_t>(count)));
    }
    if (const auto told = program_told(symbols, asked, {.during = "today"}))
      EXPECT_OK(told->validate());
  }
}

Result<AttendedQuestion> attended(const char* question, KnownFacts& facts) {
  const Lexicon lexicon(facts);
  ENGRAM_ASSIGN_OR_RETURN(
      const QuestionInWords words,
      question_in_words(question, lexicon, *make_word_tagger(), second(60), DayZone::kUtc));
  return attended_question(words, facts, lexicon, second(60), DayZone::kUtc);
}

/// Says what a test tells it to say.
class ToldNetwork final : public AttentionNetwork {
 public:
  using Tell = std::function<AttentionScores(const AttentionInput&)>;
  explicit ToldNetwork(Tell tell) : tell_(std::move(tell)) {}
  Result<AttentionScores> attend(const AttentionInput& input) override { return tell_(input); }
  [[nodiscard]] double min_confidence() const override { return 0.5; }
  [[nodiscard]] double sure_confidence() const override { return 0.95; }

 private:
  Tell tell_;
};

class Attention : public ::testing::Test {
 protected:
  void SetUp() override { kitchen_.live_one_minute(); }

  /// What is asked, with a network that reads `program` and attends to what `kept` keeps.
  std::optional<AttendedProgram> read(const char* question, const char* program, const char* kept) {
    auto facts = KnownFacts::read(kitchen_.memory());
    EXPECT_OK(facts);
    const auto asked = attended(question, **facts);
    EXPECT_OK(asked);
    const auto symbols = symbols_of(program_of(program), asked->names, asked->times);
    EXPECT_TRUE(symbols);
    AttentionScores scores;
    scores.readings.push_back({*symbols, -0.1, {}, {}});
    for (const EpisodeGroup& group : asked->groups)
      scores.readings[0].main.push_back(keeps(program_of(kept), group, asked->names) ? 5.0F
                                                                                     : -5.0F);
    scores.readings[0].other.assign(asked->groups.size(), -5.0F);
    return choose_program(scores, asked->groups, asked->names, asked->times);
  }

  RememberedKitchen kitchen_;
};

TEST_F(Attention, IsSureOfWhatItSaysTwice) {
  constexpr const char* kQuestion = "Any luck with grabbing the salt?";
  constexpr const char* kProgram = "executions skill=pick thing=salt outcome=success | exists";
  const auto same = read(kQuestion, kProgram, kProgram);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->program.to_string(), kProgram);
  EXPECT_GT(same->confidence, 0.8);
  // The symbols say success, and what is attended to is failures.
  const auto other =
      read(kQuestion, kProgram, "executions skill=pick thing=salt outcome=failure | exists");
  ASSERT_TRUE(other);
  EXPECT_LT(other->confidence, 0.1);
}

TEST_F(Attention, SaysAllNamesOfAQuestionOrNothing) {
  EXPECT_FALSE(read("Trouble with the salt?", "executions outcome=failure | exists",
                    "executions outcome=failure | exists"));
  EXPECT_FALSE(read("Trouble with the salt?", "robot | where", "robot | where"));
  EXPECT_TRUE(read("Trouble with the salt?", "executions thing=salt outcome=failure | exists",
                   "executions thing=salt outcome=failure | exists"));
}

TEST_F(Attention, IsAskedWhereNoRuleFits) {
  auto facts = KnownFacts::read(kitchen_.memory());
  ASSERT_OK(facts);
  const AskedNames kNoNames({}, Lexicon(**facts));
  const auto network = [&](double log_probability) {
    return std::make_unique<ToldNetwork>([=, &kNoNames](const AttentionInput& input) {
      AttentionScores scores;
      scores.readings.push_back(
          {*symbols_of(program_of("executions | count"), kNoNames, {}), log_probability, {}, {}});
      scores.readings[0].main.assign(input.groups.size(), 9.0F);
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
  // Whoever states something asks nothing, of whatever that is.
  for (const char* text : {"You picked up the salt.", "The violin is on the table!"})
    EXPECT_EQ(answer_of(text, -0.001, AskRoute::kAuto).route, "none") << text;
  for (const char* text :
       {"Robot, was it quick.", "Tally the times you properly grabbed something."})
    EXPECT_EQ(answer_of(text, -0.1, AskRoute::kAuto).route, "attention") << text;
  // Both read it as something else, and only what is sure counts more than a rule.
  EXPECT_EQ(answer_of("What did you do?", -0.1, AskRoute::kAuto).route, "none");
  EXPECT_EQ(answer_of("What did you do?", -0.01, AskRoute::kAuto).route, "attention");
  EXPECT_EQ(answer_of("How many things did you do in total?", -0.1, AskRoute::kAuto).route,
            "program");
  EXPECT_EQ(answer_of("Did you do anything?", -0.1, AskRoute::kReader).route, "attention");
  // Whatever a network reads in them, these say nothing.
  for (const char* text : {"a", "please", "plmk vfrt", "one two salt qwe rty uio asd fgh"})
    EXPECT_EQ(answer_of(text, -0.001, AskRoute::kReader).route, "none") << text;
}

TEST_F(Attention, KnowsNoNames) {
  auto facts = KnownFacts::read(kitchen_.memory());
  ASSERT_OK(facts);
  const auto words_of = [&](const char* question) {
    auto asked = attended(question, **facts);
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
  const auto of_salt = attended("Did you pick up the salt?", **facts);
  ASSERT_OK(of_salt);
  size_t executions = 0;
  for (const EpisodeGroup& group : of_salt->groups)
    if (group.source == ProgramSource::kExecutions) executions += group.count;
  EXPECT_EQ(executions, (*facts)->executions().size());
  EXPECT_LE(of_salt->input.attended.size(), AttentionInput::kMaxAttended);
  // A hundred words are no question.
  std::string many;
  for (int i = 0; i < 100; ++i) many += "salt ";
  EXPECT_FAILS(attended(many.c_str(), **facts), StatusCode::kInvalidArgument, "words");
}

}  // namespace
}  // namespace engram::speech
