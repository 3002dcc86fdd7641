// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "encoders/coding/orientation.h"
#include "encoders/load_model.h"
#include "ltm/idf/cast.h"
#include "ltm/recall/recall.h"
#include "ltm/recording/recorder.h"
#include "tests/training/recorded_scene.h"
#include "training/night/drop_raw.h"

namespace engram::training {
namespace {

using encoders::Quaternion;
using engram::testing::id;
using engram::testing::quick_consolidation;
using engram::testing::ScratchPath;

constexpr int kCount = 120;
constexpr int64_t kNanosecondsOfToday = 1'789'000'000'123'456'789;

idf::Type cup_type() {
  return idf::Type::object("Cup", {{"pose", idf::Type::pose()},
                                   {"fill", idf::Type::float32()},
                                   {"grasps", idf::Type::int64()},
                                   {"stamp", idf::Type::int64()}});
}

/// A cup that turns around and around.
idf::Data cup_at(int i, int64_t first_stamp = kNanosecondsOfToday) {
  idf::Data value = idf::default_value(cup_type());
  const double turn = 0.3 * i;
  const auto part = [](double x) { return static_cast<float>(x); };
  idf::Dict pose;
  pose.set("position",
           idf::NdArray::take<float>({3}, {part(std::sin(turn)), part(0.2 * std::cos(turn)),
                                           part(0.8 + 1e-4 * (i % 7))}));
  pose.set("orientation", idf::NdArray::take<float>(
                              {4}, {part(std::cos(turn / 2)), 0.0f, part(0.6 * std::sin(turn / 2)),
                                    part(0.8 * std::sin(turn / 2))}));
  auto& dict = *value.get_if<idf::Dict>();
  for (const auto& [key, member] : *dict.find("pose")->get_if<idf::Dict>())
    if (pose.find(key) == nullptr) pose.set(key, member);
  dict.set("pose", pose);
  dict.set("fill", part(0.5 + 0.1 * std::sin(0.7 * i)));
  dict.set("grasps", int64_t{i / 10});
  dict.set("stamp", first_stamp + i * 200'000'003);
  return value;
}

void record_cups(const std::filesystem::path& store, bool has_type, int first = 0,
                 int64_t first_stamp = kNanosecondsOfToday) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  if (has_type) {
    ASSERT_TRUE(recorder->declare(id("Test/Objects"), cup_type()).ok());
  }
  const auto times = engram::testing::scene_source(first + kCount).times;
  for (int i = first; i < first + kCount; ++i) {
    const ltm::Snapshot snapshot{
        id("Test/Objects/sim/cup"), times[static_cast<size_t>(i)], {{cup_at(i, first_stamp), {}}}};
    ASSERT_TRUE(recorder->commit({{snapshot}}).ok());
  }
  ASSERT_TRUE(recorder->close().ok());
}

/// What a query answers from latents.
std::vector<idf::Data> decoded_cups(const std::filesystem::path& store) {
  ltm::Recall recall(*ltm::StoreReader::open(store), encoders::load_model);
  ltm::Recall::Options prefer_latent;
  prefer_latent.prefer = ltm::Recall::Prefer::kLatent;
  const auto answer = recall.query(*ltm::Query::parse("Test @ all"), prefer_latent);
  EXPECT_TRUE(answer.ok()) << answer.status().to_string();
  std::vector<idf::Data> values;
  for (const auto& snapshot : answer->entities()[0]->snapshots) {
    EXPECT_EQ(snapshot.source, ltm::Source::kReconstructed);
    values.push_back(snapshot.instances[0].data);
  }
  return values;
}

Quaternion orientation_of(const idf::Data& cup) {
  const auto q = cup.at("pose")->at("orientation")->get_if<idf::NdArray>()->values<float>();
  return {q[0], q[1], q[2], q[3]};
}

class NumberBounds : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(WithAType, NumberBounds, ::testing::Bool());

TEST_P(NumberBounds, OfZeroKeepEveryBit) {
  const ScratchPath store("exact_numbers");
  record_cups(store.path(), GetParam());
  auto options = quick_consolidation();
  options.train.number_bound = 0.0;
  const auto report = consolidate(store.path(), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->entities[0].rmse, 0);
  const auto decoded = decoded_cups(store.path());
  ASSERT_EQ(decoded.size(), size_t{kCount});
  for (int i = 0; i < kCount; ++i) EXPECT_EQ(decoded[static_cast<size_t>(i)], cup_at(i)) << i;
}

TEST(NumberBounds, AreAnAngleWhereATypeTellsOfOrientations) {
  constexpr double kBound = 0.02;
  const ScratchPath store("turning_cup");
  record_cups(store.path(), true);
  auto options = quick_consolidation();
  options.train.number_bound = kBound;
  ASSERT_TRUE(consolidate(store.path(), options, {}, {}).ok());
  const auto decoded = decoded_cups(store.path());
  ASSERT_EQ(decoded.size(), size_t{kCount});
  double largest = 0;
  for (int i = 0; i < kCount; ++i) {
    const idf::Data& found = decoded[static_cast<size_t>(i)];
    const idf::Data recorded = cup_at(i);
    const Quaternion q = orientation_of(found), r = orientation_of(recorded);
    largest = std::max(largest, encoders::angle_between_rad(q, r));
    EXPECT_GT(q[0] * r[0] + q[1] * r[1] + q[2] * r[2] + q[3] * r[3], 0) << "turned over: " << i;
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-6);
    EXPECT_NEAR(found.at("fill")->get<float>(), recorded.at("fill")->get<float>(), kBound);
    EXPECT_EQ(*found.at("stamp"), *recorded.at("stamp"));
    EXPECT_EQ(*found.at("grasps"), *recorded.at("grasps"));
  }
  EXPECT_LE(largest, kBound + 1e-6);
  EXPECT_GT(largest, kBound / 100) << "nothing was saved";
}

// Small stamps are numbers to the first model, and stay so.
TEST(NumberBounds, LeaveRecordedWhatAnEarlierModelWouldRound) {
  const ScratchPath store("large_stamps");
  record_cups(store.path(), true, 0, 0);
  ASSERT_TRUE(consolidate(store.path(), quick_consolidation(), {}, {}).ok());
  record_cups(store.path(), true, kCount);
  auto options = quick_consolidation();
  options.reuses_models = true;
  const auto report = consolidate(store.path(), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_NE(report->entities[0].skipped_reason.find("'stamp'"), std::string::npos)
      << report->entities[0].skipped_reason;
  ltm::Recall recall(*ltm::StoreReader::open(store.path()), encoders::load_model);
  ltm::Recall::Options prefer_latent;
  prefer_latent.prefer = ltm::Recall::Prefer::kLatent;
  const auto answer = recall.query(*ltm::Query::parse("Test @ all"), prefer_latent);
  ASSERT_TRUE(answer.ok()) << answer.status().to_string();
  const auto& snapshots = answer->entities()[0]->snapshots;
  ASSERT_EQ(snapshots.size(), size_t{2 * kCount});
  EXPECT_EQ(snapshots.front().source, ltm::Source::kReconstructed);
  EXPECT_EQ(snapshots.back().source, ltm::Source::kRecorded);
  EXPECT_EQ(snapshots.back().instances[0].data, cup_at(2 * kCount - 1));
}

TEST(NumberBounds, LeavePredictedOrientationsOfLengthOne) {
  const ScratchPath store("predicted_cup");
  record_cups(store.path(), true);
  auto options = quick_consolidation();
  options.train.steps = 600;
  ASSERT_TRUE(consolidate(store.path(), options, {}, {}).ok());
  ltm::Recall recall(*ltm::StoreReader::open(store.path()), encoders::load_model);
  const auto answer = recall.query(*ltm::Query::parse("Test @ +200ms"));
  ASSERT_TRUE(answer.ok()) << answer.status().to_string();
  const auto& snapshot = answer->entities()[0]->snapshots[0];
  ASSERT_EQ(snapshot.source, ltm::Source::kPredicted);
  const Quaternion q = orientation_of(snapshot.instances[0].data);
  EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-6);
  EXPECT_GT(encoders::angle_between_rad(q, orientation_of(cup_at(kCount - 1))), 1e-3)
      << "it was copied";
}

/// An arm that swings, and another one: in training it stands still but for the last digits.
idf::Data arms_at(int i, double rest, double noisy_rest) {
  idf::Dict dict;
  dict.set("joints", idf::NdArray::take<double>({3}, {std::sin(0.2 * i), rest, noisy_rest}));
  return dict;
}

std::vector<double> joints_of(const idf::Data& arms) {
  const auto joints = arms.at("joints")->get_if<idf::NdArray>()->values<double>();
  return {joints.begin(), joints.end()};
}

TEST(NumberPredictions, GoOnFromJointsThatStoodStillInTraining) {
  TrainingSource source;
  source.entity = "Test/Robot/sim/arms";
  source.times = engram::testing::scene_source(kCount).times;
  source.read = [](size_t i) -> Result<idf::Data> {
    return arms_at(static_cast<int>(i), 0.25, 1e-12 * std::sin(static_cast<double>(i)));
  };
  const ScratchPath file("still_arm");
  const auto trained =
      train_model(source, engram::testing::quick_options(600), file.path(), {}, {});
  ASSERT_TRUE(trained.ok()) << trained.status().to_string();
  const auto model = encoders::load_model(file.path());
  ASSERT_TRUE(model.ok()) << model.status().to_string();
  const std::vector<idf::Data> past{arms_at(50, 0.88, 0.39), arms_at(51, 0.9, 0.4)};
  const auto futures = model->predictor->predict({past}, 5);
  ASSERT_TRUE(futures.ok()) << futures.status().to_string();
  ASSERT_NE(futures->front().value, past.back()) << "it was copied";
  for (const ltm::Prediction& future : *futures) {
    const std::vector<double> joints = joints_of(future.value);
    EXPECT_LT(std::abs(joints[0]), 1.5) << "what swings goes on swinging";
    EXPECT_EQ(joints[1], 0.9);
    EXPECT_NEAR(joints[2], 0.4, 1e-9);
  }
}

// A night of video said nothing of numbers, and yet each published a model of them.
TEST(Numbers, GetANewModelOnlyWhereItPaysWhateverImagesAreKeptAs) {
  for (const Representation kind : {Representation::kAuto, Representation::kVideo}) {
    const ScratchPath store("numbers_again");
    record_cups(store.path(), true);
    auto chosen = quick_consolidation();
    chosen.representation.kind = kind;
    EXPECT_TRUE(engram::testing::night(store.path(), chosen).is_model_new);
    ASSERT_TRUE(drop_raw(store.path(), id("Test/Objects/sim/cup"), {}, {}, {}).ok());
    record_cups(store.path(), true, kCount);
    const EntityReport again = engram::testing::night(store.path(), chosen);
    EXPECT_FALSE(again.is_model_new) << to_string(kind);
    EXPECT_EQ(again.choice.previous_version, 1) << to_string(kind);
    EXPECT_EQ(ltm::read_manifest(store.path())->models.size(), 1u);
  }
}

}  // namespace
}  // namespace engram::training
