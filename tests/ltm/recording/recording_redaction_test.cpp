// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <thread>

#include "ltm/recall/recall.h"
#include "ltm/recording/recorder.h"
#include "ltm/recording/recording_config.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

using testing::has_secret_file;
using ::testing::HasSubstr;
using testing::image_with_secret;
using testing::marker_redaction;

/// Stores arrays as they are, so that their bytes can be looked for.
EntityRule plain_rule() {
  EntityRule rule{"cameras", *EntityPattern::parse("Vision"), {}, {}, {}, {}};
  rule.pack.rules = {PackRule{.codec = "none"}};
  return rule;
}

class RecordingRedactionTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path store() const { return scratch_ / "store"; }

  [[nodiscard]] Commit commit(int index, bool shows_secret) const {
    const auto image = image_with_secret(64, 48, shows_secret ? 10 + index : -1, 5);
    return {{{camera_,
              time_from_ns(1'000'000'000 * int64_t{index + 1}),
              {{idf::Dict{{"n", index}, {"image", image}}, {}}}}}};
  }

  /// Records `count` snapshots of which every second shows a secret.
  RecordingCounters record(const EntityRule& rule, int count = 6) {
    auto recorder = *Recorder::open(store(), {.rules = {rule}});
    for (int i = 0; i < count; ++i) EXPECT_OK(recorder.commit(commit(i, i % 2 == 0)));
    const RecordingCounters counters = recorder.counters().begin()->second;
    was_in_journal_ = has_secret_file(store());
    EXPECT_OK(recorder.close());
    return counters;
  }

  /// Whether any file of the store held a secret before it was sealed: the journal has arrays as
  /// they are, segments compress them.
  bool was_in_journal_ = false;
  MemoryId camera_ = *MemoryId::parse("Vision/RGB/head/cam");
  ScratchDirectory scratch_;
};

TEST_F(RecordingRedactionTest, WritesWhatIsFoundIntoNoFile) {
  record(plain_rule());
  ASSERT_TRUE(was_in_journal_) << "else nothing would be proven below";
  std::filesystem::remove_all(store());
  EntityRule rule = plain_rule();
  rule.redact = marker_redaction(scratch_.path());
  const RecordingCounters counters = record(rule);
  EXPECT_FALSE(was_in_journal_);
  EXPECT_FALSE(has_secret_file(store()));
  EXPECT_EQ(counters.offered, 6u);
  EXPECT_EQ(counters.kept, 6u);
  EXPECT_EQ(counters.redacted_images, 3u);
  EXPECT_EQ(counters.redacted_boxes, 3u);
}

TEST_F(RecordingRedactionTest, DropsWithoutAnAnswerAndCountsIt) {
  EntityRule rule = plain_rule();
  rule.redact = marker_redaction(scratch_.path(), "silent");
  auto recorder = *Recorder::open(store(), {.rules = {rule}});
  ASSERT_OK(recorder.commit(commit(0, true)));
  const RecordingCounters& counters = recorder.counters().at(camera_);
  EXPECT_EQ(counters.redact_unanswered, 1u);
  EXPECT_EQ(counters.redact_dropped, 1u);
  EXPECT_EQ(counters.kept, 0u);
  // The program is killed, and those that come before it is ready again have no answer either.
  int count = 1;
  for (; recorder.counters().at(camera_).kept == 0 && count < 2000; ++count) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_OK(recorder.commit(commit(count, false)));
  }
  const auto offered = static_cast<uint64_t>(count);
  EXPECT_EQ(counters.kept, 1u);
  EXPECT_EQ(counters.offered, offered);
  EXPECT_EQ(counters.redact_unanswered, offered - 1);
  EXPECT_EQ(counters.redact_dropped, offered - 1);
  EXPECT_EQ(counters.dropped_by.at("redact"), offered - 1);
  EXPECT_FALSE(has_secret_file(store()));
  ASSERT_OK(recorder.close());
  EXPECT_FALSE(has_secret_file(store()));
  const auto summary = (*StoreReader::open(store()))->summary(camera_);
  ASSERT_OK(summary);
  EXPECT_EQ(summary->offered, offered);
  EXPECT_EQ(summary->dropped_by.at("redact"), offered - 1);
}

TEST_F(RecordingRedactionTest, CountsWhatNoDetectorLooksIn) {
  EntityRule rule = plain_rule();
  rule.redact = marker_redaction(scratch_.path());
  auto recorder = *Recorder::open(store(), {.rules = {rule}});
  std::vector<uint8_t> video(500);
  video[2] = 1, video[3] = 0x41;
  ASSERT_OK(recorder.commit({{{camera_,
                               time_from_ns(1),
                               {{idf::Dict{{"data", idf::NdArray::take({500}, video)}}, {}}}}}}));
  const RecordingCounters& counters = recorder.counters().at(camera_);
  EXPECT_EQ(counters.redact_unreadable, 1u);
  EXPECT_EQ(counters.redact_dropped, 1u);
  EXPECT_EQ(counters.redact_unanswered, 0u);
  EXPECT_EQ(counters.kept, 0u);
}

TEST_F(RecordingRedactionTest, DropsWhatIsFoundAheadOfFilters) {
  EntityRule rule = plain_rule();
  rule.redact = marker_redaction(scratch_.path());
  rule.redact->action = RedactAction::kDrop;
  rule.filters = {EqualityFilter::Options{}};
  const RecordingCounters counters = record(rule);
  EXPECT_FALSE(was_in_journal_);
  EXPECT_FALSE(has_secret_file(store()));
  EXPECT_EQ(counters.dropped_by.at("redact"), 3u);
  EXPECT_EQ(counters.offered, 6u);
  EXPECT_EQ(counters.kept, 3u);
  EXPECT_EQ(counters.filters.at(0).offered, 3u);
}

TEST_F(RecordingRedactionTest, LooksAgainAtWhatIsCastToANewerType) {
  EntityRule rule = plain_rule();
  rule.redact = marker_redaction(scratch_.path());
  auto recorder = *Recorder::open(store(), {.rules = {rule}});
  const auto type = [](idf::ElementType element) {
    return idf::Type::object("Seen", {{"image", idf::Type::ndarray_of_rank(element, 3)}});
  };
  const MemoryId segment = *MemoryId::parse("Vision/RGB");
  SegmentTypes old;
  ASSERT_OK(old.declare(segment, type(idf::ElementType::kFloat64)));
  const auto pixels = image_with_secret(64, 48, 10, 5);
  const auto bytes = pixels.values<uint8_t>();
  // Working memory redacts what it takes; here nobody did, so that it shows who looks again.
  const auto checked = CheckedSnapshot::check(
      Snapshot{
          *MemoryId::parse("Vision/RGB/head/cam"),
          time_from_ns(1),
          {{idf::Dict{{"image", idf::NdArray::take(
                                    {48, 64, 3}, std::vector<double>(bytes.begin(), bytes.end()))}},
            {}}}},
      old);
  ASSERT_OK(checked);
  const CheckedSnapshot* update = checked->snapshot.get();
  ASSERT_OK(recorder.commit_checked({&update, 1}));
  EXPECT_EQ(recorder.counters().begin()->second.redacted_images, 0u);
  ASSERT_OK(recorder.declare(segment, type(idf::ElementType::kUInt8)));
  ASSERT_OK(recorder.commit_checked({&update, 1}));
  EXPECT_EQ(recorder.counters().begin()->second.redacted_images, 1u);
  EXPECT_FALSE(has_secret_file(store()));
  ASSERT_OK(recorder.close());
}

TEST_F(RecordingRedactionTest, IsReadFromAConfiguration) {
  const auto options = parse_recording_config(
      "entities:\n  - match: Vision\n    redact: {detector: people, grow: 0.5}\n", "r.yaml");
  ASSERT_OK(options);
  ASSERT_TRUE(options->rules[0].redact);
  EXPECT_EQ(options->rules[0].redact->grow, 0.5);
  EXPECT_THAT(parse_recording_config("entities:\n  - match: Vision\n    redact: people\n", "r.yaml")
                  .status()
                  .message(),
              HasSubstr("r.yaml:3"));
  const auto opened = Recorder::open(
      store(), *parse_recording_config(
                   "entities: [{match: V, redact: {detector: {onnx: /no/such.onnx}}}]", "r.yaml"));
  EXPECT_EQ(opened.status().code(), StatusCode::kNotFound);
  EXPECT_FALSE(std::filesystem::exists(store())) << "no store is made without its detectors";
}

}  // namespace
}  // namespace engram::ltm
