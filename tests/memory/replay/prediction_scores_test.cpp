// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/prediction_scores.h"

#include <gtest/gtest.h>

#include "ltm/recall/replayed_past.h"
#include "ltm/store/store_writer.h"
#include "memory/replay/prediction_error.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::memory {
namespace {

using ltm::example_time;

TEST(PredictionError, IsTheMeanOverTheNumbersThatCount) {
  const idf::Data came = idf::Dict{{"x", 1.0}, {"y", 2.0}, {"is_on", true}};
  const idf::Data predicted = idf::Dict{{"x", 1.0}, {"y", 5.0}, {"is_on", false}};
  const auto error = prediction_error(predicted, came, {});
  ASSERT_OK(error);
  EXPECT_DOUBLE_EQ(error->number_mse, 4.5);
  EXPECT_TRUE(std::isnan(error->image_mse));
}

TEST(PredictionError, TellsImagesApart) {
  const auto value = [](uint8_t grey) {
    std::vector<uint8_t> pixels(8 * 8 * 3, grey);
    return idf::Data(
        idf::Dict{{"image", idf::NdArray::take({8, 8, 3}, std::move(pixels))}, {"x", 3.0}});
  };
  const auto error = prediction_error(value(12), value(10), {});
  ASSERT_OK(error);
  EXPECT_DOUBLE_EQ(error->image_mse, 4);
  EXPECT_DOUBLE_EQ(error->number_mse, 0);
}

TEST(PredictionError, NeedsOneLayout) {
  EXPECT_EQ(prediction_error(7.0, idf::Dict{{"x", 1.0}}, {}).status().code(),
            StatusCode::kInvalidArgument);
}

/// A past that has to be renewed so often before it can be read.
class ReplacedPast final : public ltm::KnownPast {
 public:
  ReplacedPast(ltm::KnownPast& past, int renewals) : past_(past), renewals_(renewals) {}

  [[nodiscard]] std::string name() const override { return past_.name(); }
  [[nodiscard]] std::vector<ltm::MemoryId> matching(const ltm::Query& query) override {
    return past_.matching(query);
  }
  Result<std::unique_ptr<ltm::EntityPast>> of(const ltm::MemoryId& entity) override {
    if (renewed < renewals_) return unavailable("the store was replaced");
    return past_.of(entity);
  }
  [[nodiscard]] std::optional<idf::Type> type_of(const ltm::MemoryId& entity) const override {
    return past_.type_of(entity);
  }
  Result<std::vector<ltm::Engine>> models(const ltm::MemoryId& entity) override {
    return past_.models(entity);
  }
  void keep_decoded(bool keeps) override { past_.keep_decoded(keeps); }
  Status renew() override {
    ++renewed;
    return {};
  }
  Status start_anew() override { return renew(); }
  Status follow() override { return {}; }

  int renewed = 0;

 private:
  ltm::KnownPast& past_;
  const int renewals_;
};

/// A store of snapshots five a second, and predictions of x.
class PredictionScoresTest : public ::testing::Test {
 protected:
  PredictionScoresTest() {
    EXPECT_OK(ltm::create_store(path_));
    const auto writer = *ltm::StoreWriter::open(path_, {});
    for (int64_t i = 0; i < 20; ++i)
      if (i < 10 || i > 14) EXPECT_OK(writer->append({ltm::packed_example(i)}, nullptr));
    EXPECT_OK(writer->seal());
    past_ = *ltm::ReplayedPast::open(path_, nullptr, [this] { return now_; });
  }

  void predict(Time last, Duration horizon, double x, double bound, size_t image_bytes = 0) {
    ltm::SnapshotResult predicted;
    predicted.time = last + horizon;
    predicted.source = ltm::Source::kPredicted;
    predicted.predictor = "line";
    predicted.horizon = horizon;
    idf::Data value = ltm::example_snapshot(ltm::example_entity(), 5).instances[0].data;
    value.get_if<idf::Dict>()->set("x", x);
    if (image_bytes > 0)
      value.get_if<idf::Dict>()->set("image",
                                     idf::NdArray::take({static_cast<int64_t>(image_bytes)},
                                                        std::vector<uint8_t>(image_bytes)));
    ltm::MeasuredError error, limit;
    error.number_mse = bound / 2;
    limit.number_mse = bound;
    predicted.append(std::move(value), {}, error, limit);
    ltm::Answer answer;
    answer.entities.push_back({ltm::example_entity(), {{std::move(predicted)}}});
    scores_.add(answer);
  }

  std::vector<PredictionScore> at(Time now) {
    now_ = now;
    EXPECT_OK(past_->follow());
    return scores_.compare(now, *past_);
  }

  const ScratchDirectory scratch_;
  const std::filesystem::path path_ = scratch_ / "store";
  Time now_ = example_time(0);
  std::unique_ptr<ltm::ReplayedPast> past_;
  PredictionScores scores_;
};

TEST_F(PredictionScoresTest, WaitUntilItHasCome) {
  predict(example_time(3), std::chrono::milliseconds(400), 1.25, 1);
  EXPECT_TRUE(at(example_time(4)).empty());
  // It is there a moment after its own time.
  EXPECT_TRUE(at(example_time(5)).empty());
  const auto scores = at(example_time(5) + Duration(2));
  ASSERT_EQ(scores.size(), 1u);
  EXPECT_EQ(scores[0].came, example_time(5));
  EXPECT_EQ(scores[0].engine, "line");
  EXPECT_TRUE(scores[0].has_bound());
  EXPECT_TRUE(scores[0].is_within_bound());
  EXPECT_FALSE(scores_.has_waiting());
  EXPECT_EQ(scores_.unscored(), 0u);
}

TEST_F(PredictionScoresTest, TellWhatBreaksItsBound) {
  predict(example_time(3), std::chrono::milliseconds(400), 100, 1);
  const auto scores = at(example_time(6));
  ASSERT_EQ(scores.size(), 1u);
  EXPECT_FALSE(scores[0].is_within_bound());
  EXPECT_EQ(*scores[0].to_data().at("is_within_bound"), idf::Data(false));
}

TEST_F(PredictionScoresTest, GiveUpWhereNothingCameNear) {
  // Nothing was recorded between the snapshots 9 and 15.
  predict(example_time(9), std::chrono::milliseconds(600), 1, 1);
  EXPECT_TRUE(at(example_time(14)).empty());
  EXPECT_TRUE(scores_.has_waiting());
  EXPECT_TRUE(at(example_time(16)).empty());
  EXPECT_FALSE(scores_.has_waiting());
  EXPECT_EQ(scores_.unscored(), 1u);
}

TEST_F(PredictionScoresTest, HoldABoundedNumber) {
  for (size_t i = 0; i < PredictionScores::kMaxWaiting + 10; ++i)
    predict(example_time(3), std::chrono::milliseconds(400), 1.25, 1);
  EXPECT_EQ(scores_.unscored(), 10u);
  EXPECT_EQ(at(example_time(6)).size(), PredictionScores::kMaxWaiting);
}

TEST_F(PredictionScoresTest, HoldABoundedNumberOfBytes) {
  constexpr size_t kImage = PredictionScores::kMaxWaitingBytes / 4;
  for (int i = 0; i < 10; ++i)
    predict(example_time(3), std::chrono::milliseconds(400), 1.25, 1, kImage);
  EXPECT_EQ(scores_.unscored(), 7u);
  // What waits leaves its room to others.
  EXPECT_TRUE(at(example_time(4)).empty());
  EXPECT_EQ(scores_.unscored(), 7u);
  scores_.rewind(example_time(1));
  for (int i = 0; i < 3; ++i)
    predict(example_time(3), std::chrono::milliseconds(400), 1.25, 1, kImage);
  EXPECT_EQ(scores_.unscored(), 7u);
  predict(example_time(3), std::chrono::milliseconds(400), 1.25, 1, 5 * kImage);
  EXPECT_EQ(scores_.unscored(), 11u);
  EXPECT_FALSE(scores_.has_waiting());
}

TEST_F(PredictionScoresTest, ReadTheNewestStoreIfItWasReplaced) {
  predict(example_time(3), std::chrono::milliseconds(400), 1.25, 1);
  now_ = example_time(6);
  ASSERT_OK(past_->follow());
  ReplacedPast replaced(*past_, 1);
  EXPECT_EQ(scores_.compare(now_, replaced).size(), 1u);
  EXPECT_EQ(replaced.renewed, 1);
  // It waits as long as the store cannot be read.
  predict(example_time(3), std::chrono::milliseconds(400), 1.25, 1);
  ReplacedPast gone(*past_, 100);
  EXPECT_TRUE(scores_.compare(now_, gone).empty());
  EXPECT_TRUE(scores_.has_waiting());
  EXPECT_EQ(gone.renewed, 1);
  EXPECT_TRUE(scores_.compare(example_time(5) + std::chrono::minutes(2), gone).empty());
  EXPECT_EQ(scores_.unscored(), 1u);
}

TEST_F(PredictionScoresTest, DropWhatNobodyHasAskedAfterAJumpBack) {
  predict(example_time(3), std::chrono::milliseconds(400), 1.25, 1);
  predict(example_time(8), std::chrono::milliseconds(200), 2.25, 1);
  scores_.rewind(example_time(5));
  EXPECT_EQ(at(example_time(16)).size(), 1u);
  EXPECT_EQ(scores_.unscored(), 0u);
}

}  // namespace
}  // namespace engram::memory
