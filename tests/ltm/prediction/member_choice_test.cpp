// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ltm/prediction/entity_predictor.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/print_values.h"

namespace engram::ltm {
namespace {

using idf::Data;
using idf::Dict;
using idf::NdArray;
using std::chrono::milliseconds;

const MemoryId kEntity = *MemoryId::parse("Object/Instance/kitchen/cup");
constexpr Duration kStep = milliseconds(100);
constexpr int kPeriod = 100;

/// A cup that is carried for 30 of each 100 rows, along a curve, and stands still between.
Dict cup(int row) {
  const int carried = row / kPeriod * 30 + std::min(row % kPeriod, 30);
  const double t = carried * 0.1;
  return Dict{{"position", NdArray::take<double>({3}, {std::sin(t), std::cos(0.7 * t), 1.0})},
              {"is_visible", row % 7 != 0},
              {"name", "cup"}};
}

class Cup {
 public:
  explicit Cup(int rows, EngineChoiceInputs inputs = {kEntity}) : predictor_(std::move(inputs)) {
    add_until(rows);
  }

  void add_until(int rows) {
    for (; rows_ < rows; ++rows_)
      EXPECT_OK(predictor_.add({kEntity, Time(kStep * int64_t{rows_}), {{Data(cup(rows_)), {}}}}));
  }

  SnapshotResult predict(Duration ahead, const std::string& engine = {}) {
    auto predicted = predictor_.predict({&ahead, 1}, engine);
    EXPECT_OK(predicted);
    return predicted.ok() ? predicted->front() : SnapshotResult{};
  }

 private:
  EntityPredictor predictor_;
  int rows_ = 0;
};

const MemberPrediction& member(const SnapshotResult& predicted, const std::string& path) {
  static const MemberPrediction kNone;
  for (const MemberPrediction& one : predicted.instances.at(0).members)
    if (one.path == path) return one;
  ADD_FAILURE() << "there is no member " << path;
  return kNone;
}

double distance(const SnapshotResult& predicted, int row) {
  const auto found = predicted.instances.at(0).data.at("position")->get<NdArray>();
  const Data value = cup(row);
  const auto truth = value.at("position")->get<NdArray>();
  double square = 0;
  for (size_t i = 0; i < 3; ++i)
    square += std::pow(found.values<double>()[i] - truth.values<double>()[i], 2);
  return std::sqrt(square);
}

TEST(MemberChoice, FindsWhatFollowsACarriedThingThatMostlyRests) {
  Cup cup(1015);  // In the middle of being carried.
  const SnapshotResult next = cup.predict(2 * kStep);
  EXPECT_TRUE(member(next, "position").is_moving);
  EXPECT_NE(member(next, "position").engine, "copy-last");
  EXPECT_LT(distance(next, 1016), 0.2 * distance(cup.predict(2 * kStep, "copy-last"), 1016));
  EXPECT_GT(member(next, "position").bound_mse, member(next, "position").expected_mse * 0.5);
}

TEST(MemberChoice, CopiesWhatRestsAndExpectsNoMore) {
  Cup cup(1070);
  const SnapshotResult next = cup.predict(2 * kStep);
  EXPECT_FALSE(member(next, "position").is_moving);
  EXPECT_EQ(next.predictor, "copy-last");
  EXPECT_EQ(next.instances[0].data, Data(engram::ltm::cup(1069)));
  // Moments at rest are measured apart: some of them are right before a movement.
  cup.add_until(1115);
  EXPECT_LT(member(next, "position").expected_mse,
            0.1 * member(cup.predict(2 * kStep, "copy-last"), "position").expected_mse);
}

TEST(MemberChoice, CountsNoErrorOfWhatIsOnlyCopied) {
  Cup cup(1015);
  const SnapshotResult next = cup.predict(2 * kStep);
  EXPECT_EQ(member(next, "is_visible").engine, "copy-last");
  EXPECT_EQ(member(next, "is_visible").copied, 1);
  EXPECT_TRUE(std::isnan(member(next, "is_visible").expected_mse));
  EXPECT_EQ(next.instances[0].members.size(), 2u) << "a name is no tensor";
  EXPECT_DOUBLE_EQ(next.instances[0].error->number_mse, member(next, "position").expected_mse);
  EXPECT_EQ(next.predictor, member(next, "position").engine)
      << "what is copied makes nothing mixed";
}

TEST(MemberChoice, PromisesNothingOfAFirstMovement) {
  Cup cup(0);
  EntityPredictor predictor({kEntity});
  const auto add = [&](int row, double x) {
    ASSERT_OK(predictor.add({kEntity, Time(kStep * int64_t{row}), {{Data(Dict{{"x", x}}), {}}}}));
  };
  for (int row = 0; row < 200; ++row) add(row, 1.0);
  for (int row = 200; row < 204; ++row) add(row, 1.0 + 0.1 * (row - 199));
  const Duration ahead = 2 * kStep;
  const auto next = predictor.predict({&ahead, 1}, "");
  ASSERT_OK(next);
  const MemberPrediction& x = member(next->front(), "x");
  EXPECT_EQ(x.engine, "constant-velocity");
  EXPECT_TRUE(x.is_moving);
  EXPECT_TRUE(std::isnan(x.expected_mse)) << "four moments tell nothing";
  EXPECT_TRUE(std::isnan(next->front().instances[0].bound->number_mse));
  EXPECT_NEAR(next->front().instances[0].data.at("x")->get<double>(), 1.6, 1e-9);
}

TEST(MemberChoice, KeepsItsBounds) {
  int within = 0, told = 0;
  Cup cup(1000);
  for (int row = 1000; row < 1300; ++row) {
    cup.add_until(row + 1);
    const SnapshotResult next = cup.predict(3 * kStep);
    const MemberPrediction& position = member(next, "position");
    if (std::isnan(position.bound_mse)) continue;
    ++told;
    within += std::pow(distance(next, row + 3), 2) / 3 <= position.bound_mse ? 1 : 0;
  }
  EXPECT_GT(told, 250);
  EXPECT_GT(within, 0.85 * told);
}

/// Says that it is right on all that it is asked of, and was not on what it had not seen.
class Overfitted final : public Predictor {
 public:
  [[nodiscard]] std::string_view name() const override { return "deep"; }
  [[nodiscard]] Duration step() const override { return kStep; }
  [[nodiscard]] size_t context() const override { return 1; }
  Result<std::vector<Prediction>> predict(const Past& past, int steps) override {
    const int row = static_cast<int>(std::lround(past.values.back().at("row")->get<double>()));
    std::vector<Prediction> predictions;
    for (int step = 1; step <= steps; ++step)
      predictions.push_back({Dict{{"row", 1.0 * (row + step)}, {"x", wobble(row + step)}}, {}});
    return predictions;
  }
  [[nodiscard]] std::vector<HorizonRecord> records(PredictorInputs /*inputs*/) const override {
    return {{1, 100, {std::nan(""), held_out}}, {10, 100, {std::nan(""), held_out}}};
  }
  static double wobble(int row) {
    std::mt19937_64 random(static_cast<uint64_t>(row));
    return std::uniform_real_distribution<double>(0, 1)(random);
  }

  double held_out = 0;
};

TEST(MemberChoice, DoesNotTrustAModelOnWhatItLearnedFrom) {
  for (const double held_out : {1e-9, 100.0}) {
    Overfitted model;
    model.held_out = held_out;
    EntityPredictor predictor({kEntity, {}, {{&model, "cup v1"}}, {}});
    for (int row = 0; row < 300; ++row)
      ASSERT_OK(
          predictor.add({kEntity,
                         Time(kStep * int64_t{row}),
                         {{Data(Dict{{"row", 1.0 * row}, {"x", Overfitted::wobble(row)}}), {}}}}));
    const Duration ahead = 2 * kStep;
    const auto next = predictor.predict({&ahead, 1}, "");
    ASSERT_OK(next);
    if (held_out < 1)
      EXPECT_EQ(member(next->front(), "x").engine, "deep");
    else
      EXPECT_NE(member(next->front(), "x").engine, "deep");
    const auto records = predictor.records(ahead);
    ASSERT_OK(records);
    EXPECT_EQ(records->front().engine == "deep", held_out < 1);
  }
}

/// Copies: its gates are closed.
class Closed final : public Predictor {
 public:
  [[nodiscard]] std::string_view name() const override { return "deep"; }
  [[nodiscard]] Duration step() const override { return kStep; }
  [[nodiscard]] size_t context() const override { return 1; }
  Result<std::vector<Prediction>> predict(const Past& past, int steps) override {
    return std::vector<Prediction>(static_cast<size_t>(steps), {past.values.back(), {}, 1, 1});
  }
};

TEST(MemberChoice, CallsAModelThatCopiesACopy) {
  Closed model;
  Cup cup(1, {kEntity, {}, {{&model, "cup v1"}}, {}});
  EXPECT_EQ(cup.predict(kStep, "deep").predictor, "copy-last");
  EXPECT_EQ(cup.predict(kStep).predictor, "copy-last");
}

/// Counts rollouts, and what each was asked for.
class Counting final : public Predictor {
 public:
  [[nodiscard]] std::string_view name() const override { return "deep"; }
  [[nodiscard]] Duration step() const override { return kStep; }
  [[nodiscard]] size_t context() const override { return 1; }
  Result<std::vector<Prediction>> predict(const Past& past, int steps) override {
    return std::vector<Prediction>(static_cast<size_t>(steps), {past.values.back(), {}});
  }
  Result<std::vector<Prediction>> predict_at(const Past& past,
                                             std::span<const int> steps) override {
    ++rollouts;
    moments += steps.size();
    return std::vector<Prediction>(steps.size(), {past.values.back(), {}});
  }

  size_t rollouts = 0, moments = 0;
};

TEST(MemberChoice, RunsAModelOnceForAllHorizons) {
  Counting model;
  EntityPredictor predictor({kEntity, {}, {{&model, "cup v1"}}, {}});
  for (int row = 0; row < 2; ++row)
    ASSERT_OK(predictor.add({kEntity, Time(kStep * int64_t{row}), {{Data(cup(row)), {}}}}));
  const std::vector<Duration> horizons{kStep, 5 * kStep, 30 * kStep};
  ASSERT_OK(predictor.predict(horizons, "deep"));
  const size_t rollouts = model.rollouts;
  EXPECT_EQ(model.rollouts, 1 + 1u) << "one from the last value, one from the row that is measured";
  ASSERT_OK(predictor.predict(horizons, "deep"));
  EXPECT_EQ(model.rollouts, rollouts) << "what it said is kept";
  ASSERT_OK(predictor.add({kEntity, Time(kStep * int64_t{2}), {{Data(cup(2)), {}}}}));
  ASSERT_OK(predictor.predict(horizons, "deep"));
  EXPECT_GT(model.rollouts, rollouts) << "until the next value comes";
}

}  // namespace
}  // namespace engram::ltm
