// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/event_filter.h"

#include <limits>

#include "tests/ltm/filter/candidates.h"

namespace engram::ltm {
namespace {

using std::chrono::seconds;

idf::Data force(double value) {
  return idf::Dict{{"force", value}};
}

EventRule contact(Crossing crossing = Crossing::kRising) {
  return {std::nullopt, "force", 10, crossing};
}

EventRule event_of(const std::string& entity) {
  return {*EntityPattern::parse(entity), "", 0, Crossing::kRising};
}

TEST(EntityPattern, MatchesLevelByLevel) {
  const MemoryId id = *MemoryId::parse("Vision/RGB/head/cam");
  for (const char* text : {".*", "Vision", "Vision/RGB", "Vision/.*/head/cam", "V.*/RGB/.*/c.m"})
    EXPECT_TRUE(EntityPattern::parse(text)->matches(id)) << text;
  for (const char* text : {"RGB", "Vision/Depth", ".*/.*/.*/ca", "vision"})
    EXPECT_FALSE(EntityPattern::parse(text)->matches(id)) << text;
  EXPECT_TRUE(EntityPattern::parse("a\\/b/c")->matches(*MemoryId::parse("a\\/b/c/d/e")));
  EXPECT_FAILS(EntityPattern::parse("a/b/c/d/e"), StatusCode::kInvalidArgument, "more than 4");
  EXPECT_FAILS(EntityPattern::parse("a//c"), StatusCode::kInvalidArgument, "'a//c'");
  EXPECT_FAILS(EntityPattern::parse("a/("), StatusCode::kInvalidArgument, "'a/('");
  EXPECT_FAILS(EntityPattern::parse(""), StatusCode::kInvalidArgument, "empty");
}

/// Seconds at which a rule sees events in a force that goes through `values`, one a second.
std::vector<int> events(Crossing crossing, const std::vector<double>& values) {
  EventDetector detector(contact(crossing));
  std::vector<int> found;
  for (size_t i = 0; i < values.size(); ++i)
    if (detector.is_event(candidate(static_cast<double>(i), force(values[i])).snapshot, {}))
      found.push_back(static_cast<int>(i));
  return found;
}

TEST(EventDetector, FindsCrossings) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> values{0, 20, 30, nan, 20, 5, nan, 5, 10};
  EXPECT_EQ(events(Crossing::kRising, values), (std::vector<int>{1, 8}));
  EXPECT_EQ(events(Crossing::kFalling, values), (std::vector<int>{0, 5}));
  EXPECT_EQ(events(Crossing::kEither, values), (std::vector<int>{1, 5, 8}));
}

TEST(EventDetector, LooksAtEachElementAndEachEntity) {
  EventDetector detector({*EntityPattern::parse(".*"), "f", 10, Crossing::kRising});
  const auto value = [](float a, float b) {
    return idf::Dict{{"f", idf::NdArray::take<float>({2}, {a, b})}};
  };
  EXPECT_TRUE(detector.is_event(candidate(0, value(20, 0)).snapshot, {}));
  EXPECT_TRUE(detector.is_event(candidate(1, value(20, 11)).snapshot, {}));
  EXPECT_FALSE(detector.is_event(candidate(2, value(20, 11)).snapshot, {}));
  EXPECT_TRUE(detector.is_event(candidate(3, value(20, 11), "other").snapshot, {}));
  EXPECT_FALSE(detector.is_event(candidate(4, idf::Dict{{"g", 99.0}}).snapshot, {}));
  EXPECT_FALSE(detector.is_event(candidate(5, "text").snapshot, {}));
}

TEST(EventDetector, HearsWhatSnapshotsTell) {
  const auto tells = [](std::vector<Telling> what, idf::Data value) {
    EventRule rule;
    rule.tells = std::move(what);
    EXPECT_OK(rule.validate());
    return EventDetector(rule).is_event(candidate(0, std::move(value)).snapshot, {});
  };
  const idf::Data failed = idf::Dict{{"skill", "pick"}, {"outcome", "FAILURE"}};
  EXPECT_TRUE(tells({Telling::kFailure}, failed));
  EXPECT_TRUE(tells({Telling::kSpeech, Telling::kFailure}, failed));
  EXPECT_FALSE(tells({Telling::kStop, Telling::kSuccess, Telling::kSpeech}, failed));
  EXPECT_TRUE(tells({Telling::kSpeech}, idf::Dict{{"text", "Stop!"}}));
  EXPECT_TRUE(tells({Telling::kStop}, idf::Dict{{"status", "cancelled"}}));
  EXPECT_FALSE(tells({Telling::kLinks}, idf::Dict{{"text", "Stop!"}}));
}

TEST(EventDetector, ReadsOutcomesOfEnumsByTheirNames) {
  EventRule rule;
  rule.tells = {Telling::kFailure};
  EventDetector detector(rule);
  const idf::Type type = idf::Type::object(
      "Action", {{"outcome", idf::Type::int_enum("Outcome", {{"RUNNING", 0}, {"FAILURE", 2}})}});
  EXPECT_FALSE(detector.is_event(candidate(0, idf::Dict{{"outcome", 0}}).snapshot, type));
  EXPECT_TRUE(detector.is_event(candidate(1, idf::Dict{{"outcome", 2}}).snapshot, type));
  EXPECT_FALSE(detector.is_event(candidate(2, idf::Dict{{"outcome", 2}}).snapshot, {}));
}

TEST(EventDetector, ALinkThatLeadsElsewhereIsAnEvent) {
  EventRule rule;
  rule.tells = {Telling::kLinks};
  EventDetector detector(rule);
  const auto holds = [&](double time, const std::string& link) {
    return detector.is_event(candidate(time, idf::Dict{{"held_by", link}}).snapshot, {});
  };
  EXPECT_FALSE(holds(0, "Robot/Hands/robot/left/2022-02-18 13:06:56/0"));
  EXPECT_FALSE(holds(1, "Robot/Hands/robot/left/2022-02-18 13:06:57/0"));
  EXPECT_TRUE(holds(2, "Robot/Hands/robot/right/2022-02-18 13:06:58/0"));
  EXPECT_TRUE(holds(3, ""));
  EXPECT_FALSE(holds(4, ""));
}

TEST(ImportanceFilter, KeepsWhatIsAroundAnEvent) {
  auto filter =
      *ImportanceFilter::create({.events = {contact()}, .before = seconds(2), .after = seconds(3)});
  FilterRun run(filter);
  for (int i = 0; i < 20; ++i) run.offer(candidate(i, force(i == 10 ? 50 : 0)));
  EXPECT_EQ(run.kept(), (std::vector<double>{8, 9, 10, 11, 12, 13}));
  EXPECT_EQ(filter.held().snapshots, 3u) << "17, 18 and 19 may still become important";
  run.flush();
  EXPECT_EQ(filter.held().snapshots, 0u);
  EXPECT_EQ(run.dropped("unimportant"), 14u);
}

TEST(ImportanceFilter, JoinsWindowsThatOverlap) {
  auto filter = *ImportanceFilter::create(
      {.events = {contact(Crossing::kEither)}, .before = seconds(1), .after = seconds(2)});
  FilterRun run(filter);
  for (int i = 0; i < 20; ++i) run.offer(candidate(i, force(i >= 5 && i < 8 ? 50 : 0)));
  EXPECT_EQ(run.kept(), (std::vector<double>{4, 5, 6, 7, 8, 9, 10}));
}

TEST(ImportanceFilter, KeepsABaseRateInOrder) {
  auto filter = *ImportanceFilter::create(
      {.events = {contact()}, .before = seconds(2), .after = seconds(0), .base_rate_hz = 0.25});
  FilterRun run(filter);
  for (int i = 0; i < 12; ++i) run.offer(candidate(i, force(i == 7 ? 50 : 0)));
  run.flush();
  EXPECT_EQ(run.kept(), (std::vector<double>{0, 4, 5, 6, 7, 8}));
}

TEST(ImportanceFilter, ListensToEventsOfOtherEntities) {
  auto filter = *ImportanceFilter::create(
      {.events = {event_of("a/b/c/grasp.*")}, .before = seconds(2), .after = seconds(1)});
  EXPECT_TRUE(filter.listens_to(filtered_entity("grasp-7")));
  EXPECT_FALSE(filter.listens_to(filtered_entity("cam")));
  FilterRun run(filter);
  for (int i = 0; i < 5; ++i) run.offer(candidate(i));
  run.notice(candidate(4.5, idf::None{}, "other"));
  EXPECT_TRUE(run.kept().empty());
  run.notice(candidate(4.5, idf::None{}, "grasp-7"));
  for (int i = 5; i < 9; ++i) run.offer(candidate(i));
  EXPECT_EQ(run.kept(), (std::vector<double>{3, 4, 5}));
}

TEST(ImportanceFilter, HoldsNoMoreThanItsLimit) {
  ImportanceFilter::Options options{.events = {contact()}, .before = seconds(1000)};
  options.max_held_bytes =
      10 * (candidate(0, force(0)).raw_bytes + WindowBuffer::kHeldOverheadBytes);
  auto filter = *ImportanceFilter::create(options);
  FilterRun run(filter);
  for (int i = 0; i < 25; ++i) run.offer(candidate(i, force(0)));
  EXPECT_EQ(filter.held().snapshots, 10u);
  EXPECT_EQ(run.dropped("hold limit"), 15u);
  run.offer(candidate(25, force(50)));
  EXPECT_EQ(run.kept().size(), 11u);
  EXPECT_EQ(filter.held().bytes, 0u);
}

TEST(TriggerFilter, KeepsNothingUntilTriggeredThenWhatWasBeforeAndFollows) {
  auto filter = *TriggerFilter::create({.events = {contact()}, .before = seconds(3)});
  FilterRun run(filter);
  for (int i = 0; i < 20; ++i) run.offer(candidate(i, force(i == 10 ? 50 : 0)));
  EXPECT_EQ(run.kept().front(), 7);
  EXPECT_EQ(run.kept().size(), 13u) << "all that follows";
  EXPECT_EQ(run.dropped("no trigger"), 7u);
}

TEST(TriggerFilter, ArmsItselfAgainAfterItsTime) {
  auto filter =
      *TriggerFilter::create({.events = {contact()}, .before = seconds(1), .after = seconds(2)});
  FilterRun run(filter);
  for (int i = 0; i < 30; ++i) run.offer(candidate(i, force(i % 15 == 5 ? 50 : 0)));
  EXPECT_EQ(run.kept(), (std::vector<double>{4, 5, 6, 7, 19, 20, 21, 22}));
}

TEST(EventFilters, RefuseOptionsThatAreWrong) {
  EXPECT_FAILS(ImportanceFilter::create({}), StatusCode::kInvalidArgument, "one event");
  EXPECT_FAILS(TriggerFilter::create({}), StatusCode::kInvalidArgument, "one event");
  EXPECT_FAILS(TriggerFilter::create({.events = {EventRule{}}}), StatusCode::kInvalidArgument,
               "neither an entity nor a path");
  EXPECT_FAILS(ImportanceFilter::create({.events = {contact()}, .before = seconds(-1)}),
               StatusCode::kInvalidArgument, "before is -1s");
  EXPECT_FAILS(ImportanceFilter::create({.events = {contact()}, .base_rate_hz = 0.0}),
               StatusCode::kInvalidArgument, "0 Hz");
  EventRule endless = contact();
  endless.bound = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FAILS(TriggerFilter::create({.events = {endless}}), StatusCode::kInvalidArgument, "nan");
}

}  // namespace
}  // namespace engram::ltm
