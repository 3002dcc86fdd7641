// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/learn_to_answer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "ltm/h5/h5.h"
#include "speech/attention/program_symbols.h"
#include "speech/language/asker.h"
#include "speech/learning/attention_file.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/speech/dialogues/recorded_kitchens.h"

namespace engram::speech {
namespace {

using std::chrono::milliseconds;
using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::Le;
using ::testing::Not;

/// Examples of one kitchen in the generator's own words, made once.
const std::vector<AttentionExample>& examples() {
  static const auto kExamples = [] {
    std::vector<AttentionExample> made;
    const auto counts = add_examples(kitchen_of_seed_1(),
                                     {.dialogues = {.count = 260}, .has_written = false}, {}, made);
    ENGRAM_CHECK(counts.ok(), "{}", counts.status().message());
    ENGRAM_CHECK(counts->unread + counts->unlike < counts->dialogues / 10, "{} of {}",
                 counts->unread + counts->unlike, counts->dialogues);
    return made;
  }();
  return kExamples;
}

class LearnToAnswer : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "a.attention"; }

  Result<LearnReport> learn(Duration budget, const std::filesystem::path& start = {}) {
    LearnOptions options;
    options.budget = budget;
    options.batch = 16;
    options.start = start;
    return learn_to_answer(examples(), options, file(), {}, {});
  }

  ScratchDirectory folder_;
};

TEST_F(LearnToAnswer, MakesExamplesOfProgramsAndRefusals) {
  size_t refusals = 0;
  for (const AttentionExample& one : examples()) {
    ASSERT_EQ(one.main.size(), one.groups.size());
    ASSERT_FALSE(one.symbols.empty());
    EXPECT_EQ(one.symbols.back(), kEndSymbol);
    EXPECT_EQ(link_place(one.symbols).has_value(), !one.other.empty());
    refusals += one.symbols.front() == kRefusalSymbol ? 1 : 0;
  }
  const auto trials = std::count_if(examples().begin(), examples().end(),
                                    [](const auto& one) { return one.trial != nullptr; });
  EXPECT_GT(trials, 5);
  // Most of what is held out is left out.
  EXPECT_GT(examples().size(), 110U);
  EXPECT_THAT(refusals, Gt(8U));
}

TEST_F(LearnToAnswer, WritesANetworkThatReadsQuestions) {
  const auto report = learn(milliseconds(6000));
  ASSERT_OK(report);
  EXPECT_GT(report->steps, 3);
  EXPECT_GT(report->parameters, 1'500'000);
  EXPECT_LT(report->parameters, 2'500'000);
  EXPECT_GT(report->held_out, 5U);
  // It starts at more than 5.
  EXPECT_LT(report->loss, 5);
  auto network = load_attention(file());
  ASSERT_OK(network);
  AttentionInput input{.words = examples()[0].words, .attended = examples()[0].attended};
  for (const auto& traits : examples()[0].groups) input.groups.push_back(unpacked(traits));
  const auto scores = (*network)->attend(input);
  ASSERT_OK(scores);
  ASSERT_THAT(scores->readings, Not(IsEmpty()));
  for (const AttentionScores::Reading& reading : scores->readings) {
    EXPECT_THAT(reading.log_probability, Le(0.0));
    EXPECT_EQ(reading.symbols.back(), kEndSymbol);
    EXPECT_EQ(reading.main.size(), input.groups.size());
  }
  EXPECT_GE(scores->readings.front().log_probability, scores->readings.back().log_probability);
  // The same again, and nothing to read is no question.
  EXPECT_EQ((*network)->attend(input)->readings.front().symbols, scores->readings.front().symbols);
  ASSERT_OK((*network)->attend({}));
  // Whoever is busy is waited for, and that is no time of learning: else none would be left.
  LearnOptions paused;
  paused.budget = milliseconds(100);
  size_t waits = 0;
  paused.pause = [&waits]() -> Status {
    if (waits++ == 0) std::this_thread::sleep_for(milliseconds(300));
    return {};
  };
  const auto waited = learn_to_answer(examples(), paused, folder_.path() / "b.attention", {}, {});
  ASSERT_OK(waited);
  EXPECT_GE(waited->steps, 1);
  EXPECT_EQ(waits, static_cast<size_t>(waited->steps) + 1);
  // It goes on from where it was.
  const double loss = report->loss;
  const auto more = learn(milliseconds(3000), file());
  ASSERT_OK(more);
  EXPECT_LT(more->loss, loss + 0.5);
}

TEST_F(LearnToAnswer, LeavesNoFileWhereItWasStopped) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS(learn_to_answer(examples(), {}, file(), {}, stop.get_token()),
               StatusCode::kCancelled, "stopped");
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(LearnToAnswer, GoesOnWhereItWasCutOff) {
  std::stop_source stop;
  LearnOptions options;
  options.batch = 16;
  size_t steps = 0;
  options.pause = [&]() -> Status {
    if (++steps == 4) stop.request_stop();
    return {};
  };
  EXPECT_FAILS(learn_to_answer(examples(), options, file(), {}, stop.get_token()),
               StatusCode::kCancelled, "stopped");
  auto unfinished = file();
  unfinished += ".unfinished";
  EXPECT_FALSE(std::filesystem::exists(file()));
  // It is a network, which is sure of nothing.
  const auto kept = load_attention(unfinished);
  ASSERT_OK(kept);
  EXPECT_EQ((*kept)->min_confidence(), kNeverSure);
  ASSERT_OK(learn(milliseconds(200)));
  EXPECT_TRUE(std::filesystem::exists(file()));
  EXPECT_FALSE(std::filesystem::exists(unfinished));
}

TEST_F(LearnToAnswer, MeasuresLimitsAnew) {
  const auto learned = learn(milliseconds(200));
  ASSERT_OK(learned);
  LearnOptions options;
  options.budget = Duration::zero();
  options.start = file();
  options.min_right = 0;
  options.min_refused = 0;
  auto again = file();
  again += "2";
  const auto measured = learn_to_answer(examples(), options, again, {}, {});
  ASSERT_OK(measured);
  EXPECT_EQ(measured->steps, 0);
  EXPECT_EQ(measured->read_rightly, learned->read_rightly);
  // Nobody asks for anything, so all that is read at all is told.
  EXPECT_GE(measured->told, learned->told);
  EXPECT_LE(measured->min_confidence, learned->min_confidence);
  EXPECT_OK(load_attention(again));
  options.start.clear();
  EXPECT_FAILS(learn_to_answer(examples(), options, again, {}, {}), StatusCode::kInvalidArgument,
               "budget");
}

TEST_F(LearnToAnswer, NeedsExamplesAndSense) {
  EXPECT_FAILS(learn_to_answer({examples()[0]}, {}, file(), {}, {}), StatusCode::kInvalidArgument,
               "examples");
  EXPECT_FAILS(learn_to_answer(examples(), {.budget = Duration(0)}, file(), {}, {}),
               StatusCode::kInvalidArgument, "budget");
  EXPECT_FAILS(learn_to_answer(examples(), {.batch = 0}, file(), {}, {}),
               StatusCode::kInvalidArgument, "batch");
}

TEST_F(LearnToAnswer, RefusesDamagedAndStrangeFiles) {
  EXPECT_FAILS(load_attention(file()), StatusCode::kNotFound, "a.attention");
  ASSERT_OK(learn(milliseconds(200)));
  const auto size = std::filesystem::file_size(file());
  const auto cut = folder_.path() / "cut.attention";
  std::filesystem::copy_file(file(), cut);
  std::filesystem::resize_file(cut, size / 2);
  EXPECT_FAILS(load_attention(cut), StatusCode::kDataLoss, "cut.attention");
  const auto text = folder_.path() / "text.attention";
  std::ofstream(text) << "no network";
  EXPECT_FAILS(load_attention(text), StatusCode::kDataLoss, "text.attention");
  EXPECT_FAILS(learn_to_answer(examples(), {.start = cut}, folder_.path() / "c.attention", {}, {}),
               StatusCode::kDataLoss, "cut.attention");
  // Of another version.
  const auto other = folder_.path() / "other.attention";
  {
    auto made = h5::File::create(other);
    ASSERT_OK(made);
    ASSERT_OK(made->make_group("/attention"));
    ASSERT_OK(made->write_attribute("/attention", "version", int64_t{99}));
    ASSERT_OK(made->close());
  }
  EXPECT_FAILS(load_attention(other), StatusCode::kFailedPrecondition, "99");
}

}  // namespace
}  // namespace engram::speech
