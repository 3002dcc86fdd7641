// SPDX-License-Identifier: Apache-2.0
#include "memory/memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <future>
#include <thread>

#include "ltm/recall/access_log.h"
#include "server/robot/memory_server.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/robot/running_names.h"

namespace engram {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const ltm::MemoryId kCup = *ltm::MemoryId::parse("Objects/Things/kitchen/cup");

ltm::Commit at(int64_t step, double x) {
  return {{{kCup, time_from_ns(step * 200'000'000), {{idf::Dict{{"x", x}}, {}}}}}};
}

enum class Door { kOpened, kConnected, kNamed };

/// The same memory as a program of its own has it, as a server has it, and as a name system finds
/// it.
class FrontDoor : public ::testing::TestWithParam<Door> {
 protected:
  void SetUp() override {
    if (GetParam() == Door::kOpened) {
      auto opened = Memory::open(store());
      ASSERT_OK(opened);
      memory = *std::move(opened);
      return;
    }
    server::MemoryServer::Options options;
    options.service.store.emplace();
    options.service.store->store = store();
    const std::string endpoint = "unix:" + (scratch.path() / "s").string();
    options.rpc.endpoints = {*server::Endpoint::parse(endpoint)};
    const bool is_named = GetParam() == Door::kNamed;
    if (is_named) {
      names.start();
      names_client = names.client();
    }
    auto started = server::MemoryServer::start(options, nullptr, names_client.get());
    ASSERT_OK(started);
    server = *std::move(started);
    // It registers in the background; who subscribes before is told from then on.
    for (int tries = 0; is_named && tries < 1000; ++tries) {
      const auto known = names_client->resolve("");
      if (known.ok() && !known->empty()) break;
      std::this_thread::sleep_for(milliseconds(10));
    }
    auto connected =
        Memory::connect(is_named ? names.endpoint() : endpoint, {.is_name_system = is_named});
    ASSERT_OK(connected);
    memory = *std::move(connected);
  }

  [[nodiscard]] std::filesystem::path store() const { return scratch.path() / "robot.engram"; }

  ScratchDirectory scratch;
  testing::RunningNames names;
  std::unique_ptr<server::NamesClient> names_client;
  std::unique_ptr<server::MemoryServer> server;
  std::unique_ptr<Memory> memory;
};

std::string name_of(const ::testing::TestParamInfo<Door>& door) {
  constexpr std::array kNames{"Opened", "Connected", "Named"};
  return kNames.at(static_cast<size_t>(door.param));
}

INSTANTIATE_TEST_SUITE_P(Doors, FrontDoor,
                         ::testing::Values(Door::kOpened, Door::kConnected, Door::kNamed), name_of);

TEST_P(FrontDoor, RemembersAsksThePastAndAsksTheFuture) {
  for (int64_t step = 0; step < 30; ++step)
    ASSERT_OK(memory->commit(at(step, 0.1 * static_cast<double>(step))));
  const auto past = memory->query("Objects @ latest:3");
  ASSERT_OK(past);
  ASSERT_THAT(past->find_entity(kCup)->snapshots, SizeIs(3));
  const std::vector<Duration> horizons{milliseconds(400), milliseconds(200)};
  const auto future = memory->predict(kCup, horizons);
  ASSERT_OK(future);
  ASSERT_THAT(*future, SizeIs(2));
  EXPECT_EQ((*future)[0].horizon, milliseconds(400));
  EXPECT_NEAR((*future)[0].instances[0].data.at("x")->get<double>(), 3.1, 1e-6);
  EXPECT_NEAR((*future)[1].instances[0].data.at("x")->get<double>(), 3.0, 1e-6);
  const auto engines = memory->engines(kCup, milliseconds(200));
  ASSERT_OK(engines);
  EXPECT_EQ(engines->front().engine, (*future)[1].predictor);
  const auto copied = memory->predict(kCup, horizons, "copy-last");
  ASSERT_OK(copied);
  EXPECT_EQ((*copied)[0].instances[0].data, idf::Data(idf::Dict{{"x", 0.1 * 29}}));
}

TEST_P(FrontDoor, FindsMomentsLikeAnotherOne) {
  for (int64_t step = 0; step < 30; ++step)
    ASSERT_OK(memory->commit(at(step, static_cast<double>(step % 10))));
  const ltm::SimilarRequest request{
      .entity = kCup, .moment = at(25, 0).updates[0].time, .count = 2, .apart = Duration(0)};
  const auto similar = memory->similar(request);
  ASSERT_OK(similar);
  EXPECT_EQ(similar->entity, kCup);
  EXPECT_EQ(similar->space, "numbers");
  EXPECT_EQ(similar->compared, 30u);
  ASSERT_THAT(similar->moments, SizeIs(2));
  EXPECT_EQ(similar->moments[0].time, at(15, 0).updates[0].time);
  EXPECT_NEAR(similar->moments[0].distance, 0, 1e-6);
  // What comes later is there for the next question.
  ASSERT_OK(memory->commit(at(35, 5.0)));
  EXPECT_EQ(memory->similar(request)->compared, 31u);
  // What only working memory has, too.
  ASSERT_OK(memory->commit(at(36, 6.0), CommitDurability::kMemory));
  EXPECT_EQ(memory->similar(request)->compared, 32u);
}

ltm::Commit image_at(int64_t step, int64_t left) {
  std::vector<uint8_t> pixels(size_t{48} * 64, 60);
  for (int64_t y = 16; y < 32; ++y)
    for (int64_t x = left; x < left + 14; ++x) pixels[static_cast<size_t>(y * 64 + x)] = 200;
  ltm::Commit commit = at(step, 0);
  commit.updates[0].instances[0].data =
      idf::Dict{{"image", idf::NdArray::take({48, 64, 1}, std::move(pixels))}};
  return commit;
}

TEST_P(FrontDoor, FindsMomentsLikeAnImageWhereverTheyAre) {
  for (int64_t step = 0; step < 40; ++step)
    ASSERT_OK(memory->commit(image_at(step, 2 * (step % 20)),
                             step < 20 ? CommitDurability::kJournal : CommitDurability::kMemory));
  ltm::SimilarRequest request{.entity = kCup, .count = 2, .apart = Duration(0)};
  const ltm::Commit asked = image_at(0, 14);
  request.image = *asked.updates[0].instances[0].data.at("image")->get_if<idf::NdArray>();
  const auto found = memory->similar(request);
  ASSERT_OK(found);
  EXPECT_EQ(found->compared, 40u);
  EXPECT_EQ(found->computed, 40u);
  EXPECT_THAT(found->space, ::testing::StartsWith("images "));
  ASSERT_THAT(found->moments, SizeIs(2));
  EXPECT_EQ(found->moments[0].time, at(7, 0).updates[0].time);
  EXPECT_EQ(found->moments[1].time, at(27, 0).updates[0].time);
  EXPECT_EQ(found->moments[1].distance, 0);
  EXPECT_EQ(found->moments[1].recording_first, at(0, 0).updates[0].time);
  // What was computed is there for the next question, and comparable: it is of the same space.
  ASSERT_OK(memory->commit(image_at(40, 14), CommitDurability::kMemory));
  const auto again = memory->similar(request);
  ASSERT_OK(again);
  EXPECT_EQ(again->computed, 1u);
  EXPECT_EQ(again->compared, 41u);
  EXPECT_EQ(again->space, found->space);
  // A moment that was committed again has another image.
  ASSERT_OK(memory->commit(image_at(7, 40)));
  EXPECT_EQ(memory->similar(request)->moments[0].time, at(27, 0).updates[0].time);
  request.among = *ltm::Query::parse("Objects @ 30..40");
  EXPECT_EQ(memory->similar(request)->compared, 11u);
}

TEST_P(FrontDoor, SaysWhyItCannotCompare) {
  for (int64_t step = 0; step < 5; ++step)
    ASSERT_OK(memory->commit(at(step, static_cast<double>(step))));
  const Time second = at(2, 0).updates[0].time;
  const auto nowhere = *ltm::MemoryId::parse("Objects/Things/kitchen/nowhere");
  EXPECT_FAILS(memory->similar({.entity = kCup}), StatusCode::kInvalidArgument,
               "needs a moment or an image");
  EXPECT_FAILS(memory->similar({.entity = kCup, .moment = second + Duration(1)}),
               StatusCode::kNotFound, "the moment before it is");
  EXPECT_FAILS(memory->similar({.entity = nowhere, .moment = second}), StatusCode::kNotFound,
               nowhere.to_string());
  EXPECT_FAILS(memory->similar({.entity = kCup, .moment = second, .with = {{nowhere, 1}}}),
               StatusCode::kNotFound, nowhere.to_string());
  ltm::SimilarRequest with_image{.entity = kCup};
  with_image.image = idf::NdArray::take({48, 64, 1}, std::vector<uint8_t>(size_t{48} * 64));
  EXPECT_FAILS(memory->similar(with_image), StatusCode::kInvalidArgument, "numbers and no images");
  with_image.image = idf::NdArray::take({3}, std::vector<double>{1, 2, 3});
  EXPECT_EQ(memory->similar(with_image).status().code(), StatusCode::kInvalidArgument);
  ASSERT_OK(memory->close());
  EXPECT_FAILS(memory->similar({.entity = kCup, .moment = second}), StatusCode::kFailedPrecondition,
               "closed");
}

TEST_P(FrontDoor, AnswersByPlaceAndContext) {
  const auto pose = [](double x) {
    return idf::Data(idf::Dict{{"position", idf::NdArray::take<double>({3}, {x, 0, 0})},
                               {"orientation", idf::NdArray::take<double>({4}, {1, 0, 0, 0})}});
  };
  const ltm::MemoryId push = *ltm::MemoryId::parse("Objects/Actions/robot/push");
  for (int64_t step = 0; step < 30; ++step) {
    ltm::Commit commit = at(step, 0);
    const Time time = commit.updates[0].time;
    commit.updates[0].instances[0].data =
        idf::Dict{{"pose_world_cup", pose(0.1 * static_cast<double>(step))}};
    if (step == 10)
      commit.updates.push_back(
          {push,
           time,
           {{idf::Dict{{"started", to_ns(time)},
                       {"ended", to_ns(time + milliseconds(900))},
                       {"what", kCup.at(time - milliseconds(200)).to_string()}},
             {}}}});
    ASSERT_OK(memory->commit(commit));
  }
  const auto count = [this](const std::string& query) {
    const auto answer = memory->query(query);
    EXPECT_OK(answer);
    const auto* cup = answer.ok() ? answer->find_entity(kCup) : nullptr;
    return cup == nullptr ? -1 : static_cast<int>(cup->snapshots.size());
  };
  const std::string cup = kCup.to_string();
  EXPECT_EQ(count(cup + " @ all near 1,0,0 25cm"), 5);
  EXPECT_EQ(count(cup + " @ all while " + push.to_string()), 5);
  EXPECT_EQ(count(cup + " @ all links-from " + push.to_string()), 1);
  EXPECT_EQ(count(cup + " @ all near 1,0,0 25cm not while " + push.to_string()), 2);
  const auto last = memory->query(cup + " @ latest near 1,0,0 25cm");
  ASSERT_OK(last);
  EXPECT_EQ(last->find_entity(kCup)->snapshots.at(0).time, at(12, 0).updates[0].time);
  EXPECT_FAILS(memory->query(cup + " @ all in-view Vision/x/y/camera"), StatusCode::kNotFound,
               "Vision/x/y/camera");
  EXPECT_FAILS(memory->query(cup + " @ all near 1,0,0 25cm in map"),
               StatusCode::kFailedPrecondition, "no place in frame 'map'");
}

TEST_P(FrontDoor, MapsMomentsWhereItHasTheStore) {
  for (int64_t step = 0; step < 40; ++step)
    ASSERT_OK(memory->commit(at(step, step % 20 < 10 ? 0.0 : 5.0)));
  const auto map = memory->map(kCup, 100);
  if (GetParam() != Door::kOpened) {
    EXPECT_FAILS(map, StatusCode::kFailedPrecondition, "servers make no maps");
    return;
  }
  ASSERT_OK(map);
  EXPECT_EQ(map->known, 40u);
  EXPECT_EQ(map->space, "numbers");
  ASSERT_EQ(map->times.size(), 40u);
  EXPECT_EQ(map->times.front(), at(0, 0).updates[0].time);
  // The cup was at two places.
  EXPECT_NEAR(map->x[5], map->x[25], 0.05);
  EXPECT_GT(std::abs(map->x[5] - map->x[15]), 0.5F);
  EXPECT_FAILS(memory->map(kCup, 0), StatusCode::kInvalidArgument, "at least 1 moment");
  EXPECT_FAILS(memory->map(*ltm::MemoryId::parse("Nothing/At/All/There"), 9), StatusCode::kNotFound,
               "Nothing");
}

TEST_P(FrontDoor, ExplainsWhatASnapshotIsWorthWhereItHasTheStore) {
  for (int64_t step = 0; step < 30; ++step)
    ASSERT_OK(memory->commit(at(step, step < 20 ? 0.0 : 5.0)));
  const auto moved = memory->why_salient(kCup, at(20, 0).updates[0].time);
  if (GetParam() != Door::kOpened) {
    EXPECT_FAILS(moved, StatusCode::kFailedPrecondition, "servers do not explain saliency");
    return;
  }
  ASSERT_OK(moved);
  EXPECT_EQ(moved->rank, 2u);  // After the first one.
  EXPECT_EQ(moved->count, 30u);
  EXPECT_FALSE(moved->is_stored);
  const auto last = memory->why_salient(kCup);
  ASSERT_OK(last);
  EXPECT_EQ(last->time, at(29, 0).updates[0].time);
  EXPECT_LT(last->saliency, moved->saliency);
}

TEST_P(FrontDoor, PredictsFromAnEarlierMoment) {
  for (int64_t step = 0; step < 30; ++step)
    ASSERT_OK(memory->commit(at(step, step < 20 ? 0.1 * static_cast<double>(step) : 50.0)));
  const std::vector<Duration> horizons{milliseconds(400), milliseconds(200)};
  const Time tenth = at(10, 0).updates[0].time;
  // Just after a snapshot: the last one up to it counts.
  const auto then = memory->predict(kCup, horizons, {.at = tenth + Duration(1), .engine = "line"});
  ASSERT_OK(then);
  ASSERT_THAT(*then, SizeIs(2));
  EXPECT_EQ((*then)[0].time, tenth + milliseconds(400));
  EXPECT_EQ((*then)[0].horizon, milliseconds(400));
  EXPECT_NEAR((*then)[0].instances[0].data.at("x")->get<double>(), 1.2, 1e-6);
  EXPECT_NEAR((*then)[1].instances[0].data.at("x")->get<double>(), 1.1, 1e-6);
  ASSERT_THAT((*then)[1].instances[0].members, SizeIs(1));
  EXPECT_EQ((*then)[1].instances[0].members[0].engine, "line");
  // From its newest moment: the same as without one.
  const auto now = memory->predict(kCup, horizons);
  ASSERT_OK(now);
  EXPECT_EQ(*memory->predict(kCup, horizons, {.at = at(29, 0).updates[0].time}), *now);
}

TEST_P(FrontDoor, SaysWhyItCannotPredictFromThere) {
  for (int64_t step = 0; step < 5; ++step)
    ASSERT_OK(memory->commit(at(step, static_cast<double>(step))));
  const std::vector<Duration> near{milliseconds(200)}, far{std::chrono::hours(1)}, none;
  const Time second = at(2, 0).updates[0].time;
  const auto nowhere = *ltm::MemoryId::parse("Objects/Things/kitchen/nowhere");
  EXPECT_FAILS(memory->predict(kCup, near, {.at = time_from_ns(-1)}), StatusCode::kNotFound,
               "at or before");
  EXPECT_FAILS(memory->predict(nowhere, near, {.at = second}), StatusCode::kNotFound,
               nowhere.to_string());
  EXPECT_FAILS(memory->predict(kCup, far, {.at = second}), StatusCode::kInvalidArgument,
               "at most 1min");
  EXPECT_FAILS(memory->predict(kCup, none, {.at = second}), StatusCode::kInvalidArgument,
               "horizon");
  EXPECT_FAILS(memory->predict(kCup, near, {.at = second, .engine = "oracle"}),
               StatusCode::kNotFound, "nothing named 'oracle'");
  EXPECT_FAILS(memory->predict(kCup, near, {.at = second, .plan = kCup}),
               StatusCode::kInvalidArgument, "starts from no other entity");
}

TEST_P(FrontDoor, RefusesWhatMakesNoSense) {
  EXPECT_EQ(memory->query("Objects @ all").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(memory->query("Objects @ sometimes").status().code(), StatusCode::kInvalidArgument);
  ASSERT_OK(memory->commit(at(1, 1)));
  const std::vector<Duration> none, back{milliseconds(-1)}, far{std::chrono::hours(1)};
  EXPECT_EQ(memory->predict(kCup, none).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(memory->predict(kCup, back).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(memory->predict(kCup, far).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(memory->predict(*ltm::MemoryId::parse("Objects"), far).status().code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(memory->subscribe({.names = {"("}}, {}).status().code(), StatusCode::kInvalidArgument);
}

TEST_P(FrontDoor, ChecksValuesAgainstTheirType) {
  const idf::Type type = idf::Type::object("Cup", {{"x", idf::Type::float64()}});
  ASSERT_OK(memory->declare(*ltm::MemoryId::parse("Objects/Things"), type));
  EXPECT_OK(memory->commit(at(1, 1)));
  ltm::Commit wrong = at(2, 1);
  wrong.updates[0].instances[0].data = idf::Data("a text");
  EXPECT_EQ(memory->commit(wrong).code(), StatusCode::kInvalidArgument);
}

TEST_P(FrontDoor, TellsSubscribersWhatTheyWant) {
  std::promise<std::vector<ToldSnapshot>> promise;
  bool is_told = false;
  auto subscription = memory->subscribe({.names = {"Objects"}, .with_data = true},
                                        {.on_snapshots = [&](std::vector<ToldSnapshot> told) {
                                          if (!std::exchange(is_told, true))
                                            promise.set_value(std::move(told));
                                        }});
  ASSERT_OK(subscription);
  ltm::Commit other = at(1, 1);
  other.updates[0].entity = *ltm::MemoryId::parse("Speech/Commands/human/text");
  ASSERT_OK(memory->commit(other));
  ASSERT_OK(memory->commit(at(2, 5)));
  auto told = promise.get_future();
  ASSERT_EQ(told.wait_for(std::chrono::seconds(20)), std::future_status::ready);
  const std::vector<ToldSnapshot> snapshots = told.get();
  ASSERT_THAT(snapshots, SizeIs(1));
  EXPECT_EQ(snapshots[0].snapshot.entity, kCup);
  EXPECT_EQ(snapshots[0].snapshot.instances[0].data, idf::Data(idf::Dict{{"x", 5.0}}));
  subscription->reset();
  EXPECT_OK(memory->commit(at(3, 5)));
}

TEST_P(FrontDoor, AnswersNothingOnceItIsClosed) {
  ASSERT_OK(memory->commit(at(1, 1)));
  ASSERT_OK(memory->close());
  EXPECT_FALSE(memory->commit(at(2, 1)).ok());
  EXPECT_FALSE(memory->query("Objects @ latest").ok());
  EXPECT_FALSE(memory->engines(kCup, milliseconds(200)).ok());
  EXPECT_FALSE(memory->subscribe({}, {}).ok());
  EXPECT_FALSE(memory->declare(*ltm::MemoryId::parse("A/b"), idf::Type::int64()).ok());
  if (server) ASSERT_OK(server->stop());
  const auto again = Memory::open(store(), {.is_read_only = true});
  ASSERT_OK(again);
  EXPECT_OK((*again)->query("Objects @ latest"));
}

TEST(NamedMemory, UnitesTheServersOfARobot) {
  testing::RunningNames names;
  names.start();
  const auto client = names.client();
  const ScratchDirectory scratch;
  std::vector<std::unique_ptr<server::MemoryServer>> servers;
  for (const std::string memory : {"Objects", "Robot"}) {
    server::MemoryServer::Options options;
    options.service.name = memory + "-server";
    options.service.memories = {memory};
    options.service.memory.mode = ltm::StoreMode::kLatest;
    options.rpc.endpoints = {
        *server::Endpoint::parse("unix:" + (scratch.path() / memory).string())};
    auto started = server::MemoryServer::start(options, nullptr, client.get());
    ASSERT_OK(started);
    servers.push_back(*std::move(started));
  }
  const auto memory = Memory::connect(names.endpoint(), {.is_name_system = true});
  ASSERT_OK(memory);
  const ltm::MemoryId arm = *ltm::MemoryId::parse("Robot/Joints/arm/left");
  ltm::Commit both = at(1, 1);
  both.updates.push_back(both.updates[0]);
  both.updates[1].entity = arm;
  ASSERT_OK((*memory)->commit(both));
  const auto answer = (*memory)->query(".* @ latest");
  ASSERT_OK(answer);
  EXPECT_NE(answer->find_entity(kCup), nullptr);
  EXPECT_NE(answer->find_entity(arm), nullptr);
  EXPECT_OK((*memory)->engines(arm, milliseconds(200)));
  EXPECT_EQ(
      (*memory)->engines(*ltm::MemoryId::parse("Robot/a/b/c"), milliseconds(200)).status().code(),
      StatusCode::kNotFound);
  EXPECT_EQ(Memory::connect("", {.is_name_system = true}).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(ReadMemory, NotesReadsUnlessItIsToldNotTo) {
  const ScratchDirectory scratch;
  const auto store = scratch.path() / "robot.engram";
  const auto writer = Memory::open(store);
  ASSERT_OK(writer);
  ASSERT_OK((*writer)->commit(at(1, 1)));
  ASSERT_OK((*writer)->close());
  for (const bool notes : {false, true}) {
    const auto reader = Memory::open(store, {.is_read_only = true, .notes_reads = notes});
    ASSERT_OK(reader);
    ASSERT_OK((*reader)->query("Objects @ latest"));
    ASSERT_OK((*reader)->close());
    EXPECT_EQ(ltm::read_accesses(store).empty(), !notes);
  }
}

TEST(LocalSubscription, CountsWhatASlowSubscriberMissed) {
  const ScratchDirectory scratch;
  auto memory = Memory::open(scratch.path() / "robot.engram");
  ASSERT_OK(memory);
  std::promise<void> is_told, may_go_on;
  std::atomic<uint64_t> lost{0}, told{0};
  auto subscription = (*memory)->subscribe({.queue_bound = 2},
                                           {.on_snapshots =
                                                [&](const std::vector<ToldSnapshot>& snapshots) {
                                                  if (told.fetch_add(snapshots.size()) > 0) return;
                                                  is_told.set_value();
                                                  may_go_on.get_future().wait();
                                                },
                                            .on_lost = [&](uint64_t more) { lost += more; }});
  ASSERT_OK(subscription);
  ASSERT_OK((*memory)->commit(at(1, 1), CommitDurability::kMemory));
  is_told.get_future().wait();
  for (int64_t step = 2; step <= 11; ++step)
    ASSERT_OK((*memory)->commit(at(step, 1), CommitDurability::kMemory));
  may_go_on.set_value();
  for (int tries = 0; told < 3 && tries < 1000; ++tries)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_EQ(told, 3u);
  EXPECT_EQ(lost, 8u);
  memory->reset();  // What it is of may go first.
  subscription->reset();
}

TEST(ReadMemory, SeesWhatAnotherHandedToTheStoreAndChangesNothing) {
  const ScratchDirectory scratch;
  const auto store = scratch.path() / "robot.engram";
  EXPECT_EQ(Memory::open(store, {.is_read_only = true}).status().code(), StatusCode::kNotFound);
  const auto writer = Memory::open(store);
  ASSERT_OK(writer);
  ASSERT_OK((*writer)->commit(at(1, 1)));
  EXPECT_EQ(Memory::open(store).status().code(), StatusCode::kFailedPrecondition);
  const auto reader = Memory::open(store, {.is_read_only = true});
  ASSERT_OK(reader);
  EXPECT_OK((*reader)->query("Objects @ latest"));
  ASSERT_OK((*writer)->commit(at(2, 1)));
  const auto both = (*reader)->query("Objects @ all");
  ASSERT_OK(both);
  EXPECT_THAT(both->find_entity(kCup)->snapshots, SizeIs(2)) << "what came after it was opened";
  const Status refused = (*reader)->commit(at(2, 1));
  EXPECT_EQ(refused.code(), StatusCode::kFailedPrecondition);
  EXPECT_THAT(refused.message(), HasSubstr("reading alone"));
  EXPECT_FALSE((*reader)->subscribe({}, {}).ok());
}

}  // namespace
}  // namespace engram
