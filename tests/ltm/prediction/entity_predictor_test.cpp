// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/entity_predictor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "ltm/prediction/series_engine.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/print_values.h"

namespace engram::ltm {
namespace {

using idf::Data;
using idf::Dict;
using idf::NdArray;
using std::chrono::milliseconds;

const MemoryId kEntity = *MemoryId::parse("Robot/State/arm/joints");
constexpr Duration kStep = milliseconds(100);

Time moment(int row) {
  return Time(kStep * int64_t{row});
}

Snapshot snapshot(int row, const std::vector<Data>& values) {
  Snapshot made{kEntity, moment(row), {}};
  for (const Data& value : values) made.instances.push_back({value, {}});
  return made;
}

/// Adds `rows` snapshots of what a function gives for each.
template <typename Function>
void add(EntityPredictor& predictor, int first, int last, Function value) {
  for (int row = first; row < last; ++row) {
    const Status added = predictor.add(snapshot(row, {Data(value(row))}));
    ASSERT_TRUE(added.ok()) << added.message();
  }
}

SnapshotResult predict(EntityPredictor& predictor, Duration ahead,
                       const std::string& engine = {}) {
  auto predicted = predictor.predict({&ahead, 1}, engine);
  EXPECT_TRUE(predicted.ok()) << predicted.status().to_string();
  return predicted.ok() ? predicted->front() : SnapshotResult{};
}

double wave(double row) {
  return std::sin(0.2 * row);
}

NdArray quaternion(double angle_rad, int sign = 1) {
  const double sine = std::sin(angle_rad / 2);
  return NdArray::take<double>(
      {4}, {sign * std::cos(angle_rad / 2), sign * sine * 0.6, 0.0, sign * sine * 0.8});
}

NdArray picture(int shift) {
  std::vector<uint8_t> pixels(16 * 16 * 3, 50);
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 16; ++y) pixels[static_cast<size_t>((y * 16 + (shift + x) % 16) * 3)] = 200;
  return NdArray::take<uint8_t>({16, 16, 3}, std::move(pixels));
}

TEST(EntityPredictor, TellsEngineHorizonAndError) {
  EntityPredictor predictor({kEntity});
  add(predictor, 0, 300, [](int row) {
    return Dict{{"angle", wave(row)}, {"name", "elbow"}, {"count", int64_t{row}}};
  });
  const SnapshotResult next = predict(predictor, 5 * kStep);
  EXPECT_EQ(next.source, Source::kPredicted);
  EXPECT_EQ(next.predictor, "mixed") << "a straight line counts up";
  const std::vector<MemberPrediction>& members = next.instances[0].members;
  ASSERT_EQ(members.size(), 2u) << "a name is copied, and no tensor";
  EXPECT_EQ(members[0].path, "angle");
  EXPECT_EQ(members[0].engine, "autoregression");
  EXPECT_EQ(members[1].path, "count");
  EXPECT_TRUE(members[1].is_moving);
  EXPECT_EQ(next.model, "");
  EXPECT_EQ(next.horizon, 5 * kStep);
  EXPECT_EQ(next.time, moment(304));
  ASSERT_EQ(next.instances.size(), 1u);
  EXPECT_NEAR(next.instances[0].data.at("angle")->get<double>(), wave(304), 0.02);
  EXPECT_EQ(*next.instances[0].data.at("name"), Data("elbow"));
  EXPECT_EQ(*next.instances[0].data.at("count"), Data(int64_t{304}));
  EXPECT_EQ(next.instances[0].metadata.created, next.time);
  ASSERT_TRUE(next.instances[0].error.has_value());
  EXPECT_LT(next.instances[0].error->number_mse, 1e-3);
  EXPECT_GT(next.instances[0].error->number_mse, 0);
  EXPECT_TRUE(std::isnan(next.instances[0].error->image_mse));
  EXPECT_GT(next.instances[0].bound->number_mse, 0);
  const auto records = predictor.records(5 * kStep);
  ASSERT_OK(records);
  EXPECT_EQ(records->size(), make_series_engines().size());
  EXPECT_EQ(records->front().engine, "autoregression");
  EXPECT_GT(records->front().predictions, 90u);
  EXPECT_NEAR(records->front().mean.number_mse, next.instances[0].error->number_mse, 1e-6);
}

TEST(EntityPredictor, LiesOnTheLineBetweenTwoSteps) {
  EntityPredictor predictor({kEntity});
  add(predictor, 0, 60, [](int row) { return 2.0 * row; });
  for (const double steps : {0.25, 1.0, 1.5, 7.3}) {
    const auto ahead = std::chrono::round<Duration>(steps * kStep);
    EXPECT_NEAR(predict(predictor, ahead, "line").instances[0].data.get<double>(),
                2.0 * (59 + steps), 1e-6)
        << steps;
  }
}

TEST(EntityPredictor, TurnsOnABodyThatTurns) {
  for (const double speed : {0.35, -0.05, 2.9}) {  // Per step, up to almost half a turn.
    EntityPredictor predictor({kEntity});
    add(predictor, 0, 60, [speed](int row) {
      return Dict{{"position", NdArray::take<float>({3}, {float(row), 0, 1})},
                  {"orientation", quaternion(speed * row, row % 3 == 0 ? -1 : 1)}};
    });
    for (const int steps : {1, 4, 20}) {
      const SnapshotResult next = predict(predictor, steps * kStep);
      EXPECT_NE(next.predictor, "copy-last");
      const auto found = next.instances[0].data.at("orientation")->get<NdArray>();
      const auto truth = quaternion(speed * (59 + steps));
      double product = 0, square = 0;
      for (size_t i = 0; i < 4; ++i) {
        product += found.values<double>()[i] * truth.values<double>()[i];
        square += found.values<double>()[i] * found.values<double>()[i];
      }
      EXPECT_NEAR(std::abs(product), 1, 1e-6) << speed << ", " << steps;
      EXPECT_NEAR(square, 1, 1e-12);
      EXPECT_LT(next.instances[0].error->number_mse, 1e-6);
      EXPECT_NEAR(next.instances[0].data.at("position")->get<NdArray>().values<float>()[0],
                  59 + steps, 1e-3);
    }
  }
}

TEST(EntityPredictor, ContinuesEveryInstanceByTheSameEngine) {
  EntityPredictor predictor({kEntity});
  for (int row = 0; row < 100; ++row) {
    std::vector<Data> values{Data(1.0 * row), Data(-3.0 * row), Data("no numbers")};
    if (row < 50) values.emplace_back(7.0);
    ASSERT_OK(predictor.add(snapshot(row, values)));
  }
  const SnapshotResult next = predict(predictor, 2 * kStep, "constant-velocity");
  ASSERT_EQ(next.instances.size(), 3u) << "as many as the last one has";
  EXPECT_NEAR(next.instances[0].data.get<double>(), 101, 1e-6);
  EXPECT_NEAR(next.instances[1].data.get<double>(), -303, 1e-6);
  EXPECT_EQ(next.instances[2].data, Data("no numbers"));
  EXPECT_EQ(next.instances[2].index, 2);
  EXPECT_EQ(predict(predictor, 2 * kStep).instances.size(), 3u);
}

TEST(EntityPredictor, NamesTheEnginesThatThereAre) {
  EntityPredictor predictor({kEntity});
  const Duration ahead = kStep;
  EXPECT_FAILS(predictor.predict({&ahead, 1}, ""), StatusCode::kNotFound, "no snapshot");
  EXPECT_FAILS(predictor.records(ahead), StatusCode::kNotFound, "no snapshot");
  add(predictor, 5, 6, wave);
  EXPECT_FAILS(predictor.predict({&ahead, 1}, "oracle"), StatusCode::kNotFound,
               "there is: copy-last, line, damped-line");
  for (const Duration wrong : {Duration(0), Duration(-1), Duration::max()})
    EXPECT_FAILS(predictor.predict({&wrong, 1}, ""), StatusCode::kInvalidArgument,
                 "needs a moment after");
  EntityPredictor words({kEntity});
  add(words, 0, 50, [](int row) { return "word " + std::to_string(row); });
  EXPECT_FAILS(words.predict({&ahead, 1}, "line"), StatusCode::kNotFound, "there is: copy-last");
  EXPECT_EQ(predict(words, ahead).instances[0].data, Data("word 49"));
  EXPECT_TRUE(std::isnan(predict(words, ahead).instances[0].error->number_mse));
}

TEST(EntityPredictor, RefusesWhatDoesNotComeAfter) {
  EntityPredictor predictor({kEntity});
  add(predictor, 5, 10, [](int row) { return 1.0 * row; });
  for (const int row : {9, 3})
    EXPECT_FAILS(predictor.add(snapshot(row, {Data(99.0)})), StatusCode::kInvalidArgument,
                 "needs a moment after");
  Snapshot other = snapshot(20, {Data(1.0)});
  other.entity = *MemoryId::parse("Robot/State/arm/other");
  EXPECT_FAILS(predictor.add(other), StatusCode::kInvalidArgument, "arm/other");
  EXPECT_NEAR(predict(predictor, kStep, "line").instances[0].data.get<double>(), 10, 1e-9);
}

TEST(EntityPredictor, StartsAnewWhereTheLayoutChanges) {
  EntityPredictor predictor({kEntity});
  add(predictor, 0, 100, [](int row) { return Dict{{"x", 1.0 * row}}; });
  add(predictor, 100, 101, [](int) { return Dict{{"x", 5.0f}, {"y", 1.0}}; });
  EXPECT_EQ(*predict(predictor, kStep).instances[0].data.at("x"), Data(5.0f));
  EXPECT_EQ(predict(predictor, kStep).predictor, "copy-last");
  add(predictor, 101, 140, [](int row) { return Dict{{"x", float(row)}, {"y", 1.0}}; });
  EXPECT_NEAR(*predict(predictor, kStep).instances[0].data.at("x")->as_number(), 140, 1e-3);
  // A quaternion that is none from then on is four numbers.
  add(predictor, 140, 180, [](int row) { return quaternion(0.1 * row); });
  add(predictor, 180, 181, [](int) { return NdArray::take<double>({4}, {0, 0, 0, 0}); });
  add(predictor, 181, 220, [](int row) { return quaternion(0.1 * row); });
  EXPECT_EQ(predict(predictor, kStep).instances[0].data.get<NdArray>().count(), 4);
  add(predictor, 220, 221, [](int) { return Data(); });
  EXPECT_EQ(predict(predictor, kStep).instances[0].data, Data());
  ASSERT_OK(predictor.add(snapshot(221, {})));
  EXPECT_EQ(predict(predictor, kStep).instances.size(), 0u);
}

TEST(EntityPredictor, NeverAnswersWithWhatIsNoNumber) {
  std::mt19937_64 random(3);
  const double odd[] = {
      0, -0.0, 1e308, -1e308, 5e-324, std::nan(""), std::numeric_limits<double>::infinity(), 1};
  EntityPredictor predictor({kEntity});
  add(predictor, 0, 120, [&](int row) {
    return Dict{{"a", row == 0 ? 1.0 : odd[random() % 8]},
                {"q", quaternion(odd[random() % 2] + row)}};
  });
  for (const char* engine :
       {"", "copy-last", "line", "damped-line", "constant-velocity", "quadratic", "autoregression", "related"}) {
    const SnapshotResult next = predict(predictor, 3 * kStep, engine);
    EXPECT_TRUE(std::isfinite(next.instances[0].data.at("a")->get<double>())) << engine;
    for (const double part : next.instances[0].data.at("q")->get<NdArray>().values<double>())
      EXPECT_TRUE(std::isfinite(part)) << engine;
  }
}

TEST(EntityPredictor, StaysWithinBounds) {
  const idf::Type type = idf::Type::float64({"rad", 0.0, 1.0});
  EntityPredictor predictor({kEntity, type});
  add(predictor, 0, 100, [](int row) { return 0.0099 * row; });
  EXPECT_EQ(predict(predictor, 30 * kStep, "line").instances[0].data, Data(1.0));
}

TEST(EntityPredictor, MeasuresCopiedImages) {
  EntityPredictor predictor({kEntity});
  add(predictor, 0, 60, [](int row) { return Dict{{"rgb", picture(row)}, {"x", 1.0 * row}}; });
  const auto records = predictor.records(kStep);
  ASSERT_OK(records);
  EXPECT_EQ(records->size(), make_series_engines().size());
  // One column of 16 comes, another goes, in one of three colours: 2 / 48 of 150 squared.
  for (const EngineRecord& record : *records)
    EXPECT_NEAR(record.mean.image_mse, 150 * 150 * 2 / 48.0, 1e-3) << record.engine;
  EXPECT_NE(records->front().engine, "copy-last") << "images are copied by all: numbers decide";
  const SnapshotResult next = predict(predictor, kStep);
  EXPECT_EQ(*next.instances[0].data.at("rgb"), Data(picture(59)));
  EXPECT_NEAR(next.instances[0].data.at("x")->get<double>(), 60, 1e-3);
  EntityPredictor camera({kEntity});
  add(camera, 0, 60, [](int row) { return picture(row / 2); });
  const SnapshotResult copied = predict(camera, kStep);
  EXPECT_EQ(copied.predictor, "copy-last");
  EXPECT_NEAR(copied.instances[0].error->image_mse, 150 * 150 / 48.0, 100);
  EXPECT_NEAR(copied.instances[0].bound->image_mse, 150 * 150 * 2 / 48.0, 1e-3);
  EXPECT_TRUE(std::isnan(copied.instances[0].error->number_mse));
}

/// Shifts the picture and adds `per_step` to the number; counts what it is asked.
class Shifting final : public Predictor {
 public:
  explicit Shifting(int shift, double per_step) : shift_(shift), per_step_(per_step) {}

  [[nodiscard]] std::string_view name() const override { return "deep"; }
  [[nodiscard]] Duration step() const override { return kStep; }
  [[nodiscard]] size_t context() const override { return 2; }
  [[nodiscard]] std::optional<MemoryId> condition() const override { return kEntity; }

  Result<std::vector<Prediction>> predict(const Past& past, int steps) override {
    ++asked;
    if (!past.conditions.empty()) ++told;
    const auto* last = past.values.back().at("x");
    if (last == nullptr) return invalid_argument("of another layout");
    std::vector<Prediction> predictions;
    for (int step = 1; step <= steps; ++step) {
      const double x = last->get<double>() + per_step_ * step;
      predictions.push_back(
          {Dict{{"rgb", picture(static_cast<int>(last->get<double>()) + shift_ * step)}, {"x", x}},
           {{1.0, 2.0}, {std::nan(""), std::nan("")}}});
    }
    return predictions;
  }

  int asked = 0;
  int told = 0;

 private:
  int shift_;
  double per_step_;
};

EngineChoiceInputs with_model(Predictor& predictor) {
  return {kEntity, {}, {{&predictor, "Robot/State/arm/joints v3"}}, [](const MemoryId&, Time) {
            return Result<std::optional<Data>>(Data(1.0));
          }};
}

Dict moving(int row) {
  return Dict{{"rgb", picture(row)}, {"x", 1.0 * row}};
}

TEST(EntityPredictor, AnswersWithTheModelWhereItsImagesAreBetter) {
  Shifting good(1, 0.9);
  EntityPredictor predictor(with_model(good));
  add(predictor, 0, 60, moving);
  const SnapshotResult next = predict(predictor, 2 * kStep);
  EXPECT_EQ(next.predictor, "mixed") << "the model's images are better, its numbers are not";
  EXPECT_EQ(next.instances[0].members[0].engine, "deep");
  EXPECT_NE(next.instances[0].members[1].engine, "deep");
  EXPECT_EQ(next.model, "Robot/State/arm/joints v3");
  EXPECT_EQ(*next.instances[0].data.at("rgb"), Data(picture(61)));
  EXPECT_EQ(next.instances[0].error->image_mse, 1.0) << "it tells itself";
  EXPECT_EQ(next.instances[0].bound->image_mse, 0.0) << "it does not: as measured";
  EXPECT_NEAR(next.instances[0].bound->number_mse, 0, 1e-6) << "of the engine of the number";
  EXPECT_EQ(good.told, good.asked);
  const auto records = predictor.records(2 * kStep);
  ASSERT_OK(records);
  ASSERT_EQ(records->size(), make_series_engines().size() + 1);
  for (const EngineRecord& record : *records)
    EXPECT_EQ(record.predictions, records->front().predictions) << "on the same moments";
  const int asked = good.asked;
  ASSERT_OK(predictor.records(2 * kStep));
  EXPECT_EQ(good.asked, asked) << "measured once";
  EXPECT_EQ(predict(predictor, 2 * kStep, "line").predictor, "line");
}

TEST(EntityPredictor, AnswersWithoutTheModelWhereItIsWorse) {
  Shifting bad(7, 1.0);
  EntityPredictor predictor(with_model(bad));
  add(predictor, 0, 60, moving);
  const SnapshotResult next = predict(predictor, kStep);
  EXPECT_NE(next.predictor, "deep");
  EXPECT_NE(next.predictor, "copy-last") << "images are copied, the number goes on";
  EXPECT_NEAR(next.instances[0].data.at("x")->get<double>(), 60, 1e-3);
  EXPECT_EQ(predict(predictor, kStep, "deep").predictor, "deep");
}

TEST(EntityPredictor, AsksTheModelFirstWhereNothingWasMeasured) {
  Shifting model(1, 1.0);
  EntityPredictor predictor(with_model(model));
  add(predictor, 0, 2, moving);
  EXPECT_EQ(predict(predictor, 5 * kStep).predictor, "deep");
  // Values that are no longer the model's are continued by the others.
  add(predictor, 2, 60, [](int row) { return Dict{{"y", 1.0 * row}}; });
  EXPECT_NE(predict(predictor, kStep).predictor, "deep");
  const Duration ahead = kStep;
  EXPECT_FAILS(predictor.predict({&ahead, 1}, "deep"), StatusCode::kInvalidArgument, "layout");
}

TEST(EntityPredictor, WantsFewImagesAndManyNumbers) {
  EXPECT_EQ(EntityPredictor({kEntity}).snapshots_wanted(snapshot(0, {Data(1.0)})), 4096u);
  EXPECT_EQ(EntityPredictor({kEntity}).snapshots_wanted(snapshot(0, {Data(picture(0))})), 128u);
  Shifting model(1, 1.0);
  EXPECT_EQ(EntityPredictor(with_model(model)).snapshots_wanted(snapshot(0, {moving(0)})), 64u);
  EXPECT_EQ(EntityPredictor({kEntity}).snapshots_wanted(snapshot(0, {})), 1u);
}

}  // namespace
}  // namespace engram::ltm
