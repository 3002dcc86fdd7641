// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/reflect.h"

#include <gmock/gmock.h>

#include "tests/ltm/reflection/example_arm.h"

namespace engram::ltm {
namespace {

using ::testing::HasSubstr;

TEST(Reflect, FindsNothingWhereNothingIsWrong) {
  const Reflection found = ExampleArm().reflect();
  EXPECT_EQ(found.findings.size(), 0u) << (found.findings.empty() ? "" : found.findings[0].found);
  ASSERT_EQ(found.entities.size(), 1u);
  EXPECT_TRUE(found.entities[0].is_periodic);
  EXPECT_DOUBLE_EQ(found.entities[0].median_step_s, 0.01);
  EXPECT_LT(found.entities[0].idle_share, 0.2);
  EXPECT_GT(found.looks, 5u);
}

TEST(Reflect, FindsMissingSnapshotsAndSaysHowMany) {
  ExampleArm arm;
  arm.updates.erase(arm.updates.begin() + 500, arm.updates.begin() + 550);
  arm.add(ExampleArm::id("Robot/State/arm/tick"), ExampleArm::arm_time(520), 1.0);
  const auto gaps = of_kind(arm.reflect(), ReflectionKind::kGap);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0].first, ExampleArm::arm_time(499));
  EXPECT_EQ(gaps[0].last, ExampleArm::arm_time(550));
  EXPECT_THAT(gaps[0].found, HasSubstr("50 snapshots missing"));
}

TEST(Reflect, TakesAPauseOfAllEntitiesForTheEndOfARecording) {
  ExampleArm arm;
  for (int i = 0; i < 200; ++i)
    arm.add(ExampleArm::id("Robot/State/arm/other"), ExampleArm::arm_time(10 * i), 0.01 * i);
  for (EntityUpdate& update : arm.updates)
    if (update.time >= ExampleArm::arm_time(1000)) update.time += std::chrono::hours(1);
  EXPECT_EQ(of_kind(arm.reflect(), ReflectionKind::kGap).size(), 0u);
}

TEST(Reflect, FindsASlowerRate) {
  ExampleArm arm;
  for (int i = 799; i > 600; i -= 2) arm.updates.erase(arm.updates.begin() + i);
  const Reflection found = arm.reflect();
  const auto rates = of_kind(found, ReflectionKind::kRate);
  ASSERT_EQ(rates.size(), 1u);
  EXPECT_THAT(rates[0].found, HasSubstr("at 50 Hz"));
  EXPECT_EQ(rates[0].expected, "100 Hz");
  EXPECT_EQ(of_kind(found, ReflectionKind::kGap).size(), 0u);
}

TEST(Reflect, FindsNumbersOutsideTheBoundsOfTheirType) {
  ExampleArm arm;
  arm.change(700, 703, 1, [](int, double) { return 3.5; });
  idf::Quantity bounded{"rad", -1, 1};
  const auto array = idf::Type::ndarray(idf::ElementType::kFloat64, {3}, bounded);
  const auto free = idf::Type::ndarray(idf::ElementType::kFloat64, {3});
  const auto found = of_kind(
      arm.reflect({{"Robot/State", idf::Type::object("arm::State", {{"positions", array},
                                                                    {"velocities", free}})}}),
      ReflectionKind::kOutOfBounds);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].member, "positions[1]");
  EXPECT_EQ(found[0].count, 4u);
  EXPECT_EQ(found[0].found, "3.5");
  EXPECT_EQ(found[0].expected, "-1 to 1 rad");
}

TEST(Reflect, FindsNumbersOutsideDescribedLimits) {
  ExampleArm arm;
  arm.change(700, 700, 2, [](int, double) { return -2.0; });
  const std::vector<double> lower(3, -1.0), upper(3, 1.0);
  arm.add(ExampleArm::id("Robot/Description/arm/body"), ExampleArm::arm_time(0),
          idf::Dict{{"lower", idf::NdArray::take<double>({3}, lower)},
                    {"upper", idf::NdArray::take<double>({3}, upper)}});
  const auto found = of_kind(arm.reflect(), ReflectionKind::kOutOfBounds);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].member, "positions[2]");
  EXPECT_THAT(found[0].expected, HasSubstr("Robot/Description/arm/body"));
}

TEST(Reflect, FindsWhatIsNoNumber) {
  ExampleArm arm;
  arm.change(300, 301, 0, [](int, double) { return NAN; });
  const auto found = of_kind(arm.reflect(), ReflectionKind::kNotFinite);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].found, "nan");
}

TEST(Reflect, FindsASensorThatIsStuckWhileItMoved) {
  ExampleArm arm;
  for (int i = 901; i < 960; ++i)
    arm.updates[static_cast<size_t>(i)].instances = arm.updates[900].instances;
  const auto found = of_kind(arm.reflect(), ReflectionKind::kFrozen);
  ASSERT_GE(found.size(), 1u);
  EXPECT_EQ(found[0].first, ExampleArm::arm_time(900));
  EXPECT_EQ(found[0].last, ExampleArm::arm_time(959));
}

TEST(Reflect, FindsAJointThatIsStuckByItsVelocity) {
  ExampleArm arm;
  arm.change(901, 960, 1, [](int, double) { return ExampleArm::position(900, 1); });
  const auto found = of_kind(arm.reflect(), ReflectionKind::kFrozen);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].member, "positions[1]");
  EXPECT_THAT(found[0].expected, HasSubstr("velocities[1] says"));
}

TEST(Reflect, FindsTheSameSnapshotWithAnotherTime) {
  ExampleArm arm;
  arm.add(ExampleArm::id(), ExampleArm::arm_time(400) + std::chrono::milliseconds(3),
          arm.updates[400].instances[0].data);
  const auto found = of_kind(arm.reflect(), ReflectionKind::kDuplicate);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].first, ExampleArm::arm_time(400));
}

TEST(Reflect, TellsASpikeFromAJump) {
  ExampleArm arm;
  arm.change(500, 500, 0, [](int, double value) { return value + 0.5; });
  arm.change(1200, ExampleArm::kRows - 1, 2, [](int, double value) { return value + 0.4; });
  const Reflection found = arm.reflect();
  const auto spikes = of_kind(found, ReflectionKind::kSpike);
  ASSERT_EQ(spikes.size(), 1u);
  EXPECT_EQ(spikes[0].member, "positions[0]");
  EXPECT_EQ(spikes[0].first, ExampleArm::arm_time(500));
  const auto jumps = of_kind(found, ReflectionKind::kJump);
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_EQ(jumps[0].member, "positions[2]");
  EXPECT_EQ(jumps[0].last, ExampleArm::arm_time(1200));
}

TEST(Reflect, FindsPositionsThatDriftAwayFromTheirVelocity) {
  ExampleArm arm;
  arm.change(600, 1400, 1, [](int i, double value) { return value + 0.2 * (i - 600) / 800.0; });
  arm.change(1401, ExampleArm::kRows - 1, 1, [](int, double value) { return value + 0.2; });
  const auto found = of_kind(arm.reflect(), ReflectionKind::kDrift);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].member, "positions[1]");
  EXPECT_NEAR(to_seconds(found[0].first - ExampleArm::arm_time(600)), 0, 1);
  EXPECT_NEAR(to_seconds(found[0].last - ExampleArm::arm_time(1400)), 0, 1);
}

TEST(Reflect, FindsAClockThatDrifts) {
  ExampleArm arm;
  for (size_t i = 0; i < arm.updates.size(); ++i) {
    InstanceMetadata& metadata = arm.updates[i].instances[0].metadata;
    metadata.arrived = arm.updates[i].time + std::chrono::microseconds(2000 + 50 * i);
  }
  const auto found = of_kind(arm.reflect(), ReflectionKind::kClockDrift);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].found, HasSubstr("+0.1 s more at the end"));
}

/// A camera at 20 Hz that links to the arm.
void add_camera(ExampleArm& arm, Duration late = {}) {
  for (int i = 0; i < ExampleArm::kRows; i += 5) {
    const Time time = ExampleArm::arm_time(i);
    arm.add(ExampleArm::id("Vision/RGB/arm/cam"), time + late,
            idf::Dict{{"x", 2 * ExampleArm::position(i, 0) + 1},
                      {"joints", ExampleArm::id().at(time).instance(0).to_string()}});
  }
}

idf::Type camera_type() {
  return idf::Type::object("arm::View",
                           {{"x", idf::Type::float64()}, {"joints", idf::Type::memory_link()}});
}

TEST(Reflect, FindsLinksThatLeadNowhere) {
  ExampleArm arm;
  add_camera(arm);
  arm.updates.erase(arm.updates.begin() + 500);
  arm.add(ExampleArm::id("Vision/RGB/arm/cam"), ExampleArm::arm_time(2100),
          idf::Dict{{"x", 1.0}, {"joints", "Robot/State/arm/nobody"}});
  arm.add(ExampleArm::id("Vision/RGB/arm/cam"), ExampleArm::arm_time(2105),
          idf::Dict{{"x", 1.1}, {"joints", "Elsewhere/Things/a/b"}});
  const Reflection found = arm.reflect({{"Vision/RGB", camera_type()}});
  const auto dead = of_kind(found, ReflectionKind::kDeadLink);
  ASSERT_EQ(dead.size(), 2u);
  EXPECT_EQ(dead[0].first, ExampleArm::arm_time(500));
  EXPECT_THAT(dead[1].found, HasSubstr("Robot/State/arm/nobody"));
  EXPECT_EQ(dead[1].expected, "an entity that the store has");
  const auto foreign = of_kind(found, ReflectionKind::kForeignLink);
  ASSERT_EQ(foreign.size(), 1u);
  EXPECT_EQ(foreign[0].severity, Severity::kNote);
}

TEST(Reflect, FindsALinkToAnotherTimeThanUsual) {
  ExampleArm arm;
  add_camera(arm);
  const auto other = ExampleArm::id().at(ExampleArm::arm_time(100)).instance(0).to_string();
  *arm.updates[ExampleArm::kRows + 200].instances[0].data.at("joints") = other;
  const auto found =
      of_kind(arm.reflect({{"Vision/RGB", camera_type()}}), ReflectionKind::kLinkTime);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].first, ExampleArm::arm_time(1000));
  EXPECT_EQ(found[0].found, "a link to 9 s before");
  EXPECT_EQ(found[0].expected, "the same time");
}

TEST(Reflect, FindsAnEntityWhoseClockIsOff) {
  ExampleArm arm;
  // Motion that does not repeat, so that only one shift fits.
  arm.change(0, ExampleArm::kRows - 1, 0, [](int i, double) {
    return std::sin(0.01 * i) + 0.3 * std::sin(0.037 * i + 1) + 0.1 * std::sin(0.11 * i);
  });
  for (int i = 0; i < ExampleArm::kRows; i += 5) {
    const Time time = ExampleArm::arm_time(i);
    const double x = arm.updates[static_cast<size_t>(i)]
                         .instances[0]
                         .data.at("positions")
                         ->get<idf::NdArray>()
                         .values<double>()[0];
    arm.add(ExampleArm::id("Vision/RGB/arm/cam"), time + std::chrono::milliseconds(300),
            idf::Dict{{"x", x}, {"joints", ExampleArm::id().at(time).instance(0).to_string()}});
  }
  const Reflection found = arm.reflect({{"Vision/RGB", camera_type()}});
  const auto shifts = of_kind(found, ReflectionKind::kTimeShift);
  ASSERT_EQ(shifts.size(), 1u);
  EXPECT_EQ(shifts[0].entity, ExampleArm::id("Vision/RGB/arm/cam"));
  EXPECT_THAT(shifts[0].found, HasSubstr("0.3 s later"));
}

TEST(Reflect, LooksAtWhatAQuerySelects) {
  ExampleArm arm;
  arm.change(300, 300, 0, [](int, double) { return NAN; });
  arm.write();
  auto options = reflect_options("Robot @ -500..-1");
  ASSERT_OK(options);
  auto found = reflect(arm.store(), *options);
  ASSERT_OK(found);
  EXPECT_EQ(found->snapshots, 500u);
  EXPECT_EQ(found->findings.size(), 0u);
  options = reflect_options("Robot/State");
  ASSERT_OK(options);
  found = reflect(arm.store(), *options);
  ASSERT_OK(found);
  EXPECT_EQ(found->snapshots, 2000u);
  EXPECT_EQ(of_kind(*found, ReflectionKind::kNotFinite).size(), 1u);
  EXPECT_EQ(reflect(arm.store(), *reflect_options("Nobody")).status().code(),
            StatusCode::kNotFound);
  EXPECT_EQ(reflect_options("a @ nonsense").status().code(), StatusCode::kInvalidArgument);
}

TEST(Reflect, OfAnEmptyStoreThereIsNothingToTell) {
  ScratchDirectory scratch;
  auto recorder = Recorder::open(scratch / "store", {});
  ASSERT_OK(recorder);
  ASSERT_OK(recorder->close());
  const auto found = reflect(scratch / "store");
  ASSERT_OK(found);
  EXPECT_EQ(found->entities.size(), 0u);
  EXPECT_EQ(found->findings.size(), 0u);
}

TEST(Reflect, StopsWhenItIsAskedTo) {
  ExampleArm arm;
  arm.write();
  std::stop_source source;
  source.request_stop();
  EXPECT_EQ(reflect(arm.store(), {}, {}, source.get_token()).status().code(),
            StatusCode::kCancelled);
}

TEST(Reflect, TakesValuesOfAnyForm) {
  ExampleArm arm;
  const Time start = ExampleArm::arm_time(0);
  const auto entity = ExampleArm::id("Any/Thing/at/all\x1b[31m");
  const std::vector<idf::Data> values{idf::None{},
                                      true,
                                      1,
                                      2.5F,
                                      std::string(5000, 'x'),
                                      idf::List{1, "two", 3.0},
                                      idf::Dict{{"a", idf::List{}}, {"b", idf::Dict{{"", 1}}}},
                                      idf::NdArray::take<double>({0}, {}),
                                      idf::NdArray::take<double>({2, 2}, {1, 2, 3, 4})};
  for (int i = 0; i < 90; ++i)
    arm.add(entity, start + std::chrono::milliseconds(7 * i),
            values[static_cast<size_t>(i) % values.size()]);
  EXPECT_EQ(arm.reflect().entities.size(), 2u);
}

}  // namespace
}  // namespace engram::ltm
