// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/seen_past.h"

#include <algorithm>
#include <random>

#include "ltm/memory/selector.h"
#include "tests/ltm/recall/recalled_store.h"

namespace engram::ltm {
namespace {

/// The past of an entity as a list of moments, without data.
class MomentsAlone final : public EntityPast {
 public:
  explicit MomentsAlone(const std::vector<Time>& times) : count_(times.size()), moments_(times) {}

  Result<std::optional<Time>> first() override { return moments_.first(); }
  Result<std::optional<Time>> last() override { return moments_.last(); }
  Result<std::optional<Time>> at_or_after(Time time) override { return moments_.at_or_after(time); }
  Result<std::optional<Time>> at_or_before(Time time) override {
    return moments_.at_or_before(time);
  }
  Result<std::optional<Time>> nth(uint64_t index) override { return moments_.nth(index); }
  Result<uint64_t> count() override { return count_; }
  Result<RecalledSnapshot> read(Time /*moment*/, Prefer /*prefer*/) override {
    return RecalledSnapshot{};
  }
  Result<RecalledSnapshot> name(Time /*moment*/, Prefer /*prefer*/) override {
    return RecalledSnapshot{};
  }

 private:
  uint64_t count_;
  ListedMoments moments_;
};

const std::vector<std::string> kSelectors{
    "all",         "latest",     "latest:3",      "time:25",    "time:90",    "+5ns",
    "nearest:9",   "nearest:40", "nearest:5~2ns", "before:30",  "after:30",   "until:30",
    "time:10..40", "last:15ns",  "index:-3..-1",  "index:1..4", "index:0..0", "index:-9..2"};

TEST(SeenPast, IsThatOfAnEntityWhichHasNothingElse) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int64_t> any(0, 60);
  int seen_count = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<Time> times;
    for (int i = 0; i < 20; ++i) times.push_back(time_from_ns(any(random)));
    std::ranges::sort(times);
    times.erase(std::ranges::unique(times).begin(), times.end());
    TimeWindows windows;
    for (int i = 0; i < 3; ++i) {
      const int64_t first = any(random);
      windows.add({time_from_ns(first), time_from_ns(first + any(random) / 6)});
    }
    std::vector<Time> visible;
    for (const Time time : times)
      if (windows.contains(time)) visible.push_back(time);
    const auto seen = seen_past(std::make_unique<MomentsAlone>(times), windows);
    ASSERT_OK(seen);
    ASSERT_EQ(*seen != nullptr, !visible.empty());
    if (visible.empty()) continue;
    ++seen_count;
    MomentsAlone alone(visible);
    EXPECT_EQ((*seen)->count().value(), visible.size());
    for (uint64_t i = 0; i <= visible.size(); ++i)
      EXPECT_EQ((*seen)->nth(i).value(), alone.nth(i).value());
    for (const std::string& text : kSelectors) {
      const auto selector = parse_selector(text);
      ASSERT_OK(selector);
      EXPECT_EQ(select_times(*selector, **seen).value(), select_times(*selector, alone).value())
          << text;
    }
  }
  EXPECT_GT(seen_count, 200);
}

/// Sees an entity at some times.
class ViewOfOne final : public View {
 public:
  ViewOfOne(MemoryId entity, TimeWindows times, bool predictions)
      : entity_(std::move(entity)), times_(std::move(times)), predictions_(predictions) {}

  [[nodiscard]] Sight of(const MemoryId& entity) const override {
    return entity == entity_ ? Sight{times_, TimeWindows::all(), predictions_} : Sight{};
  }

 private:
  MemoryId entity_;
  TimeWindows times_;
  bool predictions_;
};

class RecallForAView : public RecalledStore {
 protected:
  void SetUp() override {
    make_store(6, false);
    middle_.add({example_time(2), example_time(5)});
  }

  static Recall::Options options(const TimeWindows& times, bool predictions = false,
                                 const MemoryId& entity = example_entity()) {
    Recall::Options options;
    options.view = std::make_shared<ViewOfOne>(entity, times, predictions);
    return options;
  }

  /// What an answer in parts has, too.
  static Result<size_t> count_in_parts(Recall& recall, const Query& query,
                                       const Recall::Options& options) {
    ENGRAM_ASSIGN_OR_RETURN(auto cursor, recall.begin(query, options));
    size_t count = 0;
    while (!cursor.is_done()) {
      ENGRAM_ASSIGN_OR_RETURN(const Answer part, recall.next(cursor, 1));
      for (const RecalledEntity& entity : part.entities) {
        EXPECT_EQ(entity.id, example_entity());
        count += entity.snapshots.size();
      }
    }
    return count;
  }

  TimeWindows middle_;
};

TEST_F(RecallForAView, TellsOfNothingElse) {
  Recall recall = open(loader());
  for (const char* names : {".*", "Vision/RGB/head/cam", "Vision/RGB/head/.*", "?ids .*"}) {
    const auto query = Query::parse(std::string(names) + " @ all");
    ASSERT_OK(query);
    const auto result = recall.query(*query, options(middle_));
    ASSERT_OK(result);
    ASSERT_EQ(result->entities().size(), 1u) << names;
    EXPECT_EQ(result->entities()[0]->id, example_entity());
    const auto& snapshots = result->entities()[0]->snapshots;
    ASSERT_EQ(snapshots.size(), 4u);
    EXPECT_EQ(snapshots.front().time, example_time(2));
    EXPECT_EQ(snapshots.back().time, example_time(5));
    EXPECT_EQ(count_in_parts(recall, *query, options(middle_)).value(), 4u);
  }
  const auto latest = recall.query(ask("latest"), options(middle_));
  ASSERT_OK(latest);
  EXPECT_EQ(latest->entities()[0]->snapshots[0].time, example_time(5));
}

TEST_F(RecallForAView, IsAsIfWhatMayNotBeSeenWereNotThere) {
  Recall recall = open(loader());
  TimeWindows later;
  later.add({example_time(50), example_time(60)});
  for (const auto& [query, with] : std::vector<std::pair<Query, Recall::Options>>{
           {*Query::parse("Vision/RGB/head/other @ all"), options(middle_)},
           {*Query::parse("Vision/RGB/head/none @ all"), options(middle_)},
           {*Query::parse("Nothing"), options(middle_)}}) {
    for (const Status& status :
         {recall.query(query, with).status(), recall.begin(query, with).status()}) {
      EXPECT_EQ(status.code(), StatusCode::kNotFound);
      EXPECT_TRUE(status.message().ends_with("it has: Vision/RGB/head/cam")) << status.message();
    }
  }
  for (const Status& status : {recall.query(ask("all"), options(later)).status(),
                               recall.begin(ask("all"), options(later)).status()})
    EXPECT_TRUE(status.message().ends_with("it has: none")) << status.message();
}

TEST_F(RecallForAView, PredictsForThoseWhoMaySeePredictions) {
  Recall recall = open(loader());
  const Recall::PredictionRequest request{{}, {std::chrono::milliseconds(200)}, "counting"};
  const auto count = [&](const Recall::Options& with) {
    const auto result = recall.query(ask("latest, +200ms"), with);
    EXPECT_OK(result);
    EXPECT_EQ(count_in_parts(recall, ask("latest, +200ms"), with).value(),
              result->entities()[0]->snapshots.size());
    return result->entities()[0]->snapshots.size();
  };
  const Recall::Options may = options(TimeWindows::all(), true);
  EXPECT_EQ(count(may), 2u);
  EXPECT_OK(recall.predict(example_entity(), request, may));
  EXPECT_OK(recall.records(example_entity(), {}, std::chrono::milliseconds(200), may));
  for (const Recall::Options& may_not : {options(TimeWindows::all(), false), options(middle_)}) {
    EXPECT_EQ(count(may_not), 1u);
    EXPECT_FAILS(recall.predict(example_entity(), request, may_not),
                 StatusCode::kFailedPrecondition, "may not be seen");
    EXPECT_FAILS(recall.records(example_entity(), {}, std::chrono::milliseconds(200), may_not),
                 StatusCode::kFailedPrecondition, "may not be seen");
  }
  EXPECT_EQ(recall.predict(example_entity("other"), request, may).status().code(),
            StatusCode::kFailedPrecondition);
}

TEST_F(RecallForAView, PredictsNothingThatTellsOfAnotherEntity) {
  condition_ = example_entity("other");
  Recall recall = open(loader());
  const Recall::PredictionRequest request{{}, {std::chrono::milliseconds(200)}, "counting"};
  EXPECT_OK(recall.predict(example_entity(), request, {}));
  const Recall::Options may = options(TimeWindows::all(), true);
  const auto refused = recall.predict(example_entity(), request, may);
  EXPECT_FAILS(refused, StatusCode::kFailedPrecondition, "tell of another entity");
  EXPECT_EQ(refused.status().message().find("other'"), std::string::npos);
  const auto answered = recall.query(ask("latest, +200ms"), may);
  ASSERT_OK(answered);
  EXPECT_EQ(answered->entities()[0]->snapshots.size(), 1u);
}

}  // namespace
}  // namespace engram::ltm
