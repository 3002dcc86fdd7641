// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/running_replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <map>
#include <set>

#include "ltm/memory/score_id.h"
#include "memory/replay_control.h"
#include "tests/memory/replay/lived_memory.h"

namespace engram {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;
using testing::lived_at;
using testing::lived_entity;
using testing::LivedMemory;
using testing::told;
using Kind = ReplayCommand::Kind;

/// Collects what a subscriber is told.
struct Told {
  SubscriptionHandlers handlers() {
    return {[this](std::vector<ToldSnapshot> snapshots) {
              const MutexLock lock(mutex);
              for (const ToldSnapshot& one : snapshots) ids.push_back(one.snapshot.id());
              changed.notify_all();
            },
            {},
            {}};
  }
  std::vector<ltm::MemoryId> wait(size_t count) {
    const MutexLock lock(mutex);
    changed.wait_for(mutex, seconds(20),
                     [&]() ENGRAM_REQUIRES(mutex) { return ids.size() >= count; });
    return ids;
  }

  Mutex mutex;
  ConditionVariable changed;
  std::vector<ltm::MemoryId> ids ENGRAM_GUARDED_BY(mutex);
};

std::unique_ptr<Memory> paused(const std::filesystem::path& store, Time at) {
  auto memory = Memory::replay(store, {.at = at, .is_paused = true});
  EXPECT_OK(memory);
  return *std::move(memory);
}

/// A bar of the replay: at 1,000 random moments of a life answers have the bytes that they had.
TEST(Replay, AnswersAsTheRobotDidAtThousandMoments) {
  LivedMemory lived;
  struct Asked {
    Time at{};
    std::string query;
    std::string answer;
  };
  std::vector<Asked> asked;
  std::mt19937 random(3);
  const auto ask = [&](Time at) {
    const std::string entity = lived_entity(static_cast<int>(random() % 4)).to_string();
    const std::string moment =
        std::to_string(to_ns(lived_at(static_cast<double>(random() % 13'000) / 1000)));
    const std::vector<std::string> queries{"Robot @ latest",
                                           entity + " @ latest:5",
                                           entity + " @ -4..-2",
                                           entity + " @ 3..7",
                                           entity + " @ nearest:" + moment,
                                           entity + " @ before:" + moment,
                                           entity + " @ last:300ms",
                                           "?ids Robot @ last:500ms",
                                           entity + " @ after:" + moment,
                                           entity + " @ until:" + moment,
                                           "Nobody @ latest"};
    const std::string& query = queries[random() % queries.size()];
    asked.push_back({at, query, lived.ask(query)});
  };
  lived.live(12, [&](Time at) {
    if (random() % 100 < 99) ask(at);
  });
  lived.end();
  ASSERT_GE(asked.size(), 1000u);
  std::ranges::shuffle(asked, random);
  asked.resize(1000);
  const auto replay = paused(lived.path, lived_at(5));
  size_t without = 0;
  for (const Asked& one : asked) {
    ASSERT_OK(control_replay(*replay, {.kind = Kind::kSeek, .time = one.at}));
    std::string answer = told(replay->query(one.query));
    if (one.answer.find("no entity matches") != std::string::npos) {
      // Messages name the place, and a replay has the entities of SystemState/Replay as well.
      ASSERT_THAT(answer, HasSubstr("no entity matches '" + one.query.substr(0, 6))) << one.query;
      ++without;
      continue;
    }
    ASSERT_EQ(answer, one.answer) << one.query << " at " << to_string(one.at);
  }
  EXPECT_LT(without, 200u);
}

/// The x that an answer tells; checks that it predicts so far from `at`.
std::vector<double> predicted_of(const std::string& answer, Time at) {
  const auto data = idf::decode(Buffer::copy(as_bytes(answer)));
  EXPECT_OK(data);
  const auto result = ltm::QueryResult::from_data(*data);
  EXPECT_OK(result);
  std::vector<double> predicted;
  for (const ltm::SnapshotResult& one : result->entities().at(0)->snapshots) {
    EXPECT_EQ(one.source, ltm::Source::kPredicted);
    // The newest was measured 60 ms before at most.
    EXPECT_NEAR(to_seconds(one.time - at), predicted.empty() ? 0.2 : 1.0, 0.061);
    EXPECT_FALSE(one.predictor.empty());
    predicted.push_back(*one.instances.at(0).data.at("x")->as_number());
  }
  return predicted;
}

TEST(Replay, PredictsAsTheRobotDidAlthoughTheFutureIsKnown) {
  LivedMemory lived;
  const std::string query = lived_entity(1).to_string() + " @ +200ms, +1s";
  std::vector<std::pair<Time, std::string>> asked;
  size_t count = 0;
  lived.live(8, [&](Time at) {
    if (++count % 40 == 0) asked.emplace_back(at, lived.ask(query));
  });
  lived.end();
  ASSERT_GE(asked.size(), 15u);
  const auto replay = paused(lived.path, lived_at(0.1));
  std::map<Time, std::vector<double>> predicted_at;
  std::set<std::vector<double>> different;
  for (const auto& [at, answer] : asked) {
    ASSERT_OK(control_replay(*replay, {.kind = Kind::kSeek, .time = at}));
    const auto again = told(replay->query(query));
    ASSERT_EQ(again, answer) << to_string(at);
    const std::vector<double> predicted = predicted_of(again, at);
    ASSERT_EQ(predicted.size(), 2u);
    different.insert(predicted);
    predicted_at[at] = predicted;
  }
  EXPECT_GE(different.size(), asked.size() - 1);
  // No engine hits what came later to the last digit.
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kSeek, .time = lived_at(8)}));
  const auto all = replay->query(lived_entity(1).to_string() + " @ all");
  ASSERT_OK(all);
  const auto& came = all->entities().at(0)->snapshots;
  size_t compared = 0;
  for (const auto& [at, predicted] : predicted_at) {
    for (const ltm::SnapshotResult& one : came) {
      if (one.time <= at) continue;
      ++compared;
      EXPECT_NE(*one.instances.at(0).data.at("x")->as_number(), predicted[1]);
    }
  }
  EXPECT_GT(compared, 10 * asked.size());
}

TEST(Replay, TellsSubscribersInTheRecordedOrderAtAnySpeed) {
  LivedMemory lived;
  lived.live(3);
  lived.end();
  for (const double speed : {1.0, 10.0, 1000.0}) {
    const auto replay = paused(lived.path, lived_at(0));
    Told told;
    const auto subscription =
        replay->subscribe({.names = {"Robot"}, .queue_bound = 100'000}, told.handlers());
    ASSERT_OK(subscription);
    ASSERT_OK(control_replay(*replay, {.kind = Kind::kSpeed, .speed = speed}));
    ASSERT_OK(control_replay(*replay, {.kind = Kind::kPlay}));
    // The first arrived at the moment that the replay began with.
    EXPECT_EQ(told.wait(lived.came.size() - 1),
              std::vector(lived.came.begin() + 1, lived.came.end()));
  }
}

TEST(Replay, TellsWhatWasMeasured) {
  LivedMemory lived;
  lived.live(1);
  lived.end();
  const auto replay = paused(lived.path, lived_at(0));
  std::promise<ToldSnapshot> first;
  std::atomic<bool> is_told{false};
  const auto subscription = replay->subscribe({.names = {"Robot"}, .with_data = true},
                                              {[&](std::vector<ToldSnapshot> told) {
                                                 if (!is_told.exchange(true))
                                                   first.set_value(std::move(told.front()));
                                               },
                                               {},
                                               {}});
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kStep}));
  const ToldSnapshot told = first.get_future().get();
  const auto recorded = replay->query(told.snapshot.entity.to_string() + " @ latest");
  ASSERT_OK(recorded);
  const ltm::SnapshotResult& latest = recorded->entities()[0]->snapshots[0];
  EXPECT_EQ(told.snapshot.id(), told.snapshot.entity.at(latest.time));
  EXPECT_EQ(told.snapshot.instances[0].data, latest.instances[0].data);
  EXPECT_EQ(told.snapshot.instances[0].metadata, latest.instances[0].metadata);
}

TEST(Replay, HasTheStateOfEveryEntityAfterASeek) {
  LivedMemory lived;
  lived.live(5);
  lived.end();
  const auto replay = paused(lived.path, lived_at(0.5));
  for (const double at : {4.0, 0.5, 2.5}) {
    ASSERT_OK(control_replay(*replay, {.kind = Kind::kSeek, .time = lived_at(at)}));
    const auto latest = replay->query("Robot @ latest");
    ASSERT_OK(latest);
    ASSERT_EQ(latest->entities().size(), 4u);
    for (const ltm::EntityResult* entity : latest->entities()) {
      ASSERT_EQ(entity->snapshots.size(), 1u);
      EXPECT_LE(entity->snapshots[0].time, lived_at(at));
      EXPECT_GT(entity->snapshots[0].time, lived_at(at - 0.2));
    }
  }
}

TEST(Replay, StepsToTheNextCommit) {
  LivedMemory lived;
  lived.live(1);
  lived.end();
  const auto replay = paused(lived.path, lived_at(0));
  for (size_t i = 1; i < 10; ++i) {
    ASSERT_OK(control_replay(*replay, {.kind = Kind::kStep}));
    const ltm::MemoryId& id = lived.came[i];
    const std::string moment = std::to_string(to_ns(*id.time()));
    const auto there = replay->query(id.entity().to_string() + " @ " + moment);
    ASSERT_OK(there);
    EXPECT_EQ(there->entities()[0]->snapshots.at(0).source, ltm::Source::kRecorded);
    const auto state = replay_state(*replay);
    ASSERT_OK(state);
    EXPECT_EQ(state->now, there->entities()[0]->snapshots[0].instances[0].metadata.arrived);
    EXPECT_EQ(state->told, i);
  }
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kSeek, .time = lived_at(100)}));
  const Status behind = control_replay(*replay, {.kind = Kind::kStep});
  EXPECT_EQ(behind.code(), StatusCode::kNotFound);
  EXPECT_THAT(std::string(behind.message()), HasSubstr("nothing was recorded after"));
}

TEST(Replay, KeepsCommitsUntilItJumpsBeforeThem) {
  LivedMemory lived;
  lived.live(3);
  lived.end();
  const auto replay = paused(lived.path, lived_at(1));
  const ltm::MemoryId grasp = *ltm::MemoryId::parse("Grasp/Plan/test/cup");
  // Programs stamp with clocks of their own.
  ASSERT_OK(replay->commit({{{grasp, lived_at(900), {{idf::Dict{{"x", 1.0}}, {}}}}}},
                           CommitDurability::kJournal));
  const auto has_it = [&] { return replay->query("Grasp @ latest").ok(); };
  EXPECT_TRUE(has_it());
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kSeek, .time = lived_at(2)}));
  EXPECT_TRUE(has_it());
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kSeek, .time = lived_at(0.5)}));
  EXPECT_FALSE(has_it());
  // A recorded moment is replaced as long as the commit is there.
  const ltm::MemoryId joint = lived.came[2];
  ASSERT_OK(replay->commit({{{joint.entity(), *joint.time(), {{idf::Dict{{"x", 9.0}}, {}}}}}}));
  const std::string moment =
      joint.entity().to_string() + " @ " + std::to_string(to_ns(*joint.time()));
  const auto changed = replay->query(moment);
  ASSERT_OK(changed);
  EXPECT_EQ(changed->entities()[0]->snapshots[0].instances[0].data,
            idf::Data(idf::Dict{{"x", 9.0}}));
  ASSERT_OK(replay->close());
  const auto again = paused(lived.path, lived_at(2.9));
  const auto recorded = again->query(moment);
  ASSERT_OK(recorded);
  EXPECT_NE(told(recorded), told(changed));
}

TEST(Replay, RepeatsALoop) {
  LivedMemory lived;
  lived.live(3);
  lived.end();
  const auto replay = Memory::replay(
      lived.path, {.at = lived_at(1), .speed = 20, .loop = ReplayLoop{lived_at(1), lived_at(2)}});
  ASSERT_OK(replay);
  Told told;
  const auto subscription =
      (*replay)->subscribe({.names = {"Robot/.*/.*/joint0"}}, told.handlers());
  ASSERT_OK(subscription);
  const auto ids = told.wait(40);
  ASSERT_GE(ids.size(), 40u);
  size_t turns = 0;
  for (size_t i = 1; i < ids.size(); ++i) turns += *ids[i].time() < *ids[i - 1].time() ? 1 : 0;
  EXPECT_GE(turns, 2u);
  for (const ltm::MemoryId& id : ids) EXPECT_LE(*id.time(), lived_at(2));
  EXPECT_GE(replay_state(**replay)->jumps, 2u);
  ASSERT_OK(control_replay(**replay, {.kind = Kind::kLoop}));
  EXPECT_FALSE(replay_state(**replay)->loop);
}

TEST(Replay, EntersALoopThatLiesBeforeWhereItBegins) {
  LivedMemory lived;
  lived.live(3);
  lived.end();
  const ReplayLoop loop{lived_at(1), lived_at(2)};
  const auto begin = [&](double at) {
    const auto replay =
        Memory::replay(lived.path, {.at = lived_at(at), .is_paused = true, .loop = loop});
    EXPECT_OK(replay);
    return replay_state(**replay)->now;
  };
  EXPECT_EQ(begin(2.5), lived_at(1));
  EXPECT_EQ(begin(2), lived_at(2));
  EXPECT_EQ(begin(0.5), lived_at(0.5));
}

TEST(Replay, ScoresPredictionsWhenWhatTheyAreOfComes) {
  LivedMemory lived;
  lived.live(6);
  lived.end();
  const auto replay = paused(lived.path, lived_at(4));
  const ltm::MemoryId joint = lived_entity(2);
  ASSERT_OK(replay->query(joint.to_string() + " @ +200ms"));
  EXPECT_EQ(replay_state(*replay)->scored, 0u);
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kSeek, .time = lived_at(4.1)}));
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kSpeed, .speed = 10}));
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kPlay}));
  const std::string scores = ltm::score_id(joint).to_string();
  Result<ltm::QueryResult> answer = not_found("not asked");
  for (int tries = 0; tries < 1000 && !answer.ok(); ++tries) {
    std::this_thread::sleep_for(milliseconds(5));
    answer = replay->query(scores + " @ latest");
  }
  ASSERT_OK(answer);
  const idf::Data& score = answer->entities()[0]->snapshots.at(0).instances.at(0).data;
  EXPECT_EQ(score.at("horizon")->get<int64_t>(), 200'000'000);
  EXPECT_LT(*score.at("error/number_mse")->as_number(), 0.1);
  EXPECT_TRUE(score.at("bound/number_mse")->as_number());
  EXPECT_TRUE(score.at("is_within_bound")->is<bool>());
  const int64_t away = score.at("came")->get<int64_t>() - score.at("time")->get<int64_t>();
  EXPECT_LE(std::abs(away), 60'000'000);
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kPause}));
  EXPECT_EQ(replay_state(*replay)->scored, 1u);
  EXPECT_EQ(replay_state(*replay)->bounded, 1u);
}

TEST(Replay, SaysWhatItIs) {
  LivedMemory lived;
  lived.live(2);
  lived.end();
  const auto replay = paused(lived.path, lived_at(1));
  auto state = replay_state(*replay);
  ASSERT_OK(state);
  EXPECT_EQ(state->now, lived_at(1));
  EXPECT_EQ(state->stores, std::vector{lived.path.string()});
  EXPECT_FALSE(state->is_playing);
  ASSERT_OK(control_replay(*replay, {.kind = Kind::kSpeed, .speed = 0.5}));
  state = replay_state(*replay);
  ASSERT_OK(state);
  EXPECT_EQ(state->speed, 0.5);
  const auto memory = Memory::open(lived.path, {.is_read_only = true});
  ASSERT_OK(memory);
  const Status none = control_replay(**memory, {.kind = Kind::kPlay});
  EXPECT_EQ(none.code(), StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(none.message()), HasSubstr("is no replay"));
}

TEST(Replay, RefusesWhatIsNot) {
  LivedMemory lived;
  lived.live(2);
  lived.end();
  const auto message = [](const auto& result) { return std::string(result.status().message()); };
  EXPECT_THAT(message(Memory::replay(lived.path, {.at = lived_at(-10)})),
              HasSubstr("lies before the first snapshot at 2023-11-14 22:13:"));
  EXPECT_THAT(message(Memory::replay(lived.path, {.at = lived_at(1), .speed = 0})),
              HasSubstr("found a speed of 0, needs one from 0.001 to 1000"));
  EXPECT_THAT(message(Memory::replay(
                  lived.path, {.at = lived_at(1), .loop = ReplayLoop{lived_at(1), lived_at(1)}})),
              HasSubstr("needs one that ends later"));
  EXPECT_EQ(Memory::replay(lived.path / "none", {.at = lived_at(1)}).status().code(),
            StatusCode::kNotFound);
  const auto replay = paused(lived.path, lived_at(1));
  const auto commit = [&](idf::Data value) {
    return std::string(
        replay->commit({{{replay_control_entity(), lived_at(1), {{std::move(value), {}}}}}})
            .message());
  };
  EXPECT_THAT(commit(idf::Dict{{"command", std::string("rewind")}}),
              HasSubstr("found 'rewind', needs one of 'play', 'pause', 'step', 'seek'"));
  EXPECT_THAT(commit(idf::Dict{{"command", std::string("seek")}}),
              HasSubstr("'time' is missing, needs a time"));
  EXPECT_THAT(commit(7), HasSubstr("has no text 'command'"));
  EXPECT_THAT(commit(idf::Dict{{"command", std::string("seek")},
                               {"time", std::string("2001-01-01 00:00:00")}}),
              HasSubstr("lies before the first snapshot"));
  EXPECT_EQ(replay_state(*replay)->now, lived_at(1));
}

}  // namespace
}  // namespace engram
