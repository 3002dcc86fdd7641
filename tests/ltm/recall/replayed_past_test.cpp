// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/replayed_past.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "ltm/idf/binary.h"
#include "ltm/recall/overlaid_past.h"
#include "tests/ltm/recall/recalled_store.h"

namespace engram::ltm {
namespace {

using std::chrono::milliseconds;

constexpr int64_t kEntities = 5;
constexpr int64_t kSnapshots = 30;

Time at_ms(int64_t ms) {
  return time_from_ns(kExampleStart_ns) + milliseconds(ms);
}

/// Snapshots of several entities that arrived late, early, out of order or at their own times, in
/// the order of their arrivals. Their values link to the snapshots before them.
std::vector<Snapshot> lived(std::mt19937& random) {
  std::map<std::pair<Time, MemoryId>, Snapshot> by_arrival;
  for (int64_t entity = 0; entity < kEntities; ++entity) {
    const MemoryId id = example_entity("cam" + std::to_string(entity));
    for (int64_t i = 0; i < kSnapshots; ++i) {
      const Time time = at_ms(i * 100 + entity);
      Time arrived = time;
      if (entity == 1) arrived += milliseconds(30);
      if (entity == 2) arrived += milliseconds(random() % 400);
      if (entity == 3) arrived += milliseconds(static_cast<int64_t>(random() % 2000) - 1000);
      idf::Dict value{{"x", static_cast<double>(i * i)},
                      {"link", id.at(at_ms((i - 1) * 100 + entity)).to_string()}};
      const InstanceMetadata metadata{time, time, arrived, "test", 1.0f};
      by_arrival.insert({{arrived, id.at(time)}, {id, time, {{std::move(value), metadata}}}});
    }
  }
  std::vector<Snapshot> all;
  for (auto& [arrival, snapshot] : by_arrival) all.push_back(std::move(snapshot));
  return all;
}

/// Writes snapshots as a robot does: in several segments, the last ones in a journal.
void write(const std::filesystem::path& path, std::span<const Snapshot> snapshots, size_t seals) {
  ASSERT_OK(create_store(path));
  const auto writer = *StoreWriter::open(path, {});
  const size_t every = std::max<size_t>(snapshots.size() / (seals + 1), 1);
  for (size_t i = 0; i < snapshots.size(); ++i) {
    ASSERT_OK(writer->append({pack_snapshot(snapshots[i])}, nullptr));
    if ((i + 1) % every == 0 && (i + 1) / every <= seals) ASSERT_OK(writer->seal());
  }
}

/// A question in every way that there is to select.
std::vector<std::string> questions(std::mt19937& random, Time now) {
  const auto plain = [&] {
    return std::to_string(to_ns(at_ms(static_cast<int64_t>(random() % 4000) - 500)));
  };
  std::vector<std::string> selectors{"all",  "latest", "latest:3", "+200ms",     "+1s",
                                     "0..2", "-3..-1", "4..9",     "last:500ms", "latest#0"};
  const std::string exactly = std::to_string(to_ns(now));
  for (const std::string& moment : {plain(), plain(), exactly}) {
    selectors.push_back("time:" + moment);
    for (const char* word : {"nearest:", "before:", "at-or-before:", "after:", "until:"})
      selectors.push_back(word + moment);
    selectors.push_back("nearest:" + moment + "~150ms");
  }
  selectors.push_back(std::to_string(to_ns(at_ms(700))) + ".." +
                      std::to_string(to_ns(at_ms(9000))));
  selectors.push_back(std::to_string(to_ns(at_ms(-1500))) + ".." + exactly);
  std::vector<std::string> all;
  for (const std::string& selector : selectors) {
    const std::string one = "Vision/RGB/head/cam" + std::to_string(random() % kEntities);
    all.push_back(".* @ " + selector);
    all.push_back(one + " @ " + selector);
    all.push_back("?ids " + one + " @ " + selector);
    all.push_back(one + " @ all, " + selector);
  }
  // What links to a moment, or is linked from one, may have come later than the moment.
  const auto entity = [&] { return "Vision/RGB/head/cam" + std::to_string(random() % kEntities); };
  for (const char* condition : {"linked-to ", "not linked-to ", "links-from ", "not links-from "}) {
    all.push_back(entity() + " @ all " + condition + entity());
    all.push_back(entity() + " @ latest:2 " + condition + entity() + "/" + plain());
    all.push_back(".* @ latest " + std::string(condition) + entity());
  }
  return all;
}

/// What is told, without the place that tells it.
std::string told(const Result<QueryResult>& answer, const std::string& place) {
  if (answer.ok()) {
    const auto bytes = idf::encode(answer->to_data());
    return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
  }
  std::string text = answer.status().to_string();
  if (const size_t at = text.find(place); at != std::string::npos) text.erase(at, place.size());
  return text;
}

/// The oracle is a store that has nothing but what had arrived by then.
TEST(ReplayedPast, AnswersAsAStoreThatEndedThere) {
  std::mt19937 random(7);
  for (int round = 0; round < 4; ++round) {
    const ScratchDirectory scratch;
    const std::vector<Snapshot> all = lived(random);
    write(scratch / "all", all, round);
    Time now = at_ms(0);
    Recall replayed(*ReplayedPast::open(scratch / "all", nullptr, [&now] { return now; }));
    // Moments of any order: forth and back, also exactly at an arrival and a nanosecond before one.
    for (int moment = 0; moment < 12; ++moment) {
      // After a jump back engines have learned nothing, as those of the oracle.
      now = at_ms(-1000);
      EXPECT_EQ(replayed.query(*Query::parse(".*")).status().code(), StatusCode::kNotFound);
      now = moment % 3 == 0 ? at_ms(static_cast<int64_t>(random() % 4000))
                            : all[random() % all.size()].instances[0].metadata.arrived;
      if (moment % 3 == 2) now -= Duration(1);
      std::vector<Snapshot> before;
      for (const Snapshot& one : all)
        if (one.instances[0].metadata.arrived <= now) before.push_back(one);
      const auto path = scratch / ("until" + std::to_string(moment));
      write(path, before, 0);
      Recall oracle(*StoreReader::open(path), nullptr);
      for (const std::string& text : questions(random, now)) {
        const auto query = Query::parse(text);
        ASSERT_OK(query);
        ASSERT_EQ(told(replayed.query(*query), (scratch / "all").string()),
                  told(oracle.query(*query), path.string()))
            << text << " at " << to_string(now);
      }
    }
  }
}

TEST(ReplayedPast, FindsNoLinkToWhatCameLater) {
  std::mt19937 random(3);
  const ScratchDirectory scratch;
  const std::vector<Snapshot> all = lived(random);
  write(scratch / "all", all, 1);
  Time now{};
  Recall replayed(*ReplayedPast::open(scratch / "all", nullptr, [&now] { return now; }));
  for (const Snapshot& one : all) {
    const std::string link = one.entity.to_string() + " @ time:" + std::to_string(to_ns(one.time));
    now = one.instances[0].metadata.arrived;
    const auto there = replayed.query(*Query::parse(link));
    ASSERT_OK(there);
    ASSERT_EQ(there->entities().size(), 1u);
    ASSERT_EQ(there->entities()[0]->snapshots.at(0).source, Source::kRecorded);
    now -= Duration(1);
    const auto before = replayed.query(*Query::parse(link));
    if (!before.ok()) continue;
    for (const EntityResult* entity : before->entities())
      for (const SnapshotResult& snapshot : entity->snapshots)
        ASSERT_EQ(snapshot.source, Source::kPredicted) << one.id().to_string();
  }
}

TEST(ReplayedPast, PredictsFromAMomentAndByAPlanFromWhatWasKnownAlone) {
  std::mt19937 random(5);
  const ScratchDirectory scratch;
  const std::vector<Snapshot> all = lived(random);
  write(scratch / "all", all, 1);
  Time now = at_ms(1500);
  Recall replayed(*ReplayedPast::open(scratch / "all", nullptr, [&now] { return now; }));
  const MemoryId cam = example_entity("cam0");
  const auto from_later = replayed.predict(cam, {at_ms(2500), {milliseconds(200)}}, {});
  const auto from_now = replayed.predict(cam, {at_ms(1500), {milliseconds(200)}}, {});
  ASSERT_OK(from_later);
  ASSERT_OK(from_now);
  EXPECT_EQ(*from_later, *from_now);
  EXPECT_EQ(from_now->front().time, at_ms(1700));
  const auto records = replayed.records(cam, at_ms(2900), milliseconds(200), {});
  const auto records_now = replayed.records(cam, at_ms(1500), milliseconds(200), {});
  ASSERT_OK(records);
  ASSERT_OK(records_now);
  EXPECT_EQ(records->front().engine, records_now->front().engine);
  EXPECT_EQ(records->front().mean, records_now->front().mean);
}

/// Late snapshots may come without that the last one changes.
TEST(ReplayedPast, DropsWhatEnginesLearnedWhenItJumpsBack) {
  const ScratchDirectory scratch;
  std::vector<Snapshot> all;
  const MemoryId cam = example_entity();
  for (int64_t i = 0; i < 30; ++i) {
    const bool is_late = i >= 10 && i < 25;
    const InstanceMetadata metadata{{}, {}, at_ms(is_late ? 9000 + i : i * 100), "test", 1.0f};
    const double x = is_late ? 100.0 * static_cast<double>(i % 3) : static_cast<double>(i);
    all.push_back({cam, at_ms(i * 100), {{idf::Dict{{"x", x}}, metadata}}});
  }
  write(scratch / "all", all, 0);
  Time now = at_ms(3000);
  Recall replayed(*ReplayedPast::open(scratch / "all", nullptr, [&now] { return now; }));
  const Query ahead = *Query::parse(cam.to_string() + " @ +200ms");
  const auto before = replayed.query(ahead);
  now = at_ms(20'000);
  const auto later = replayed.query(ahead);
  now = at_ms(3000);
  const auto again = replayed.query(ahead);
  ASSERT_OK(before);
  ASSERT_OK(later);
  ASSERT_OK(again);
  EXPECT_EQ(before->to_data(), again->to_data());
  Recall fresh(*ReplayedPast::open(scratch / "all", nullptr, [] { return at_ms(20'000); }));
  EXPECT_NE(before->to_data(), fresh.query(ahead)->to_data());
}

/// A night before the replayed moment made model 1, one after it model 2.
class ReplayedModels : public RecalledStore {
 protected:
  Recall replay(Time& now, std::vector<std::optional<Time>> trained_until) {
    auto loads = [this, trained_until](const std::filesystem::path& file) -> Result<LoadedModel> {
      auto model = loader()(file);
      ENGRAM_RETURN_IF_ERROR(model.status());
      const bool is_second = file.string().find("v2") != std::string::npos ||
                             file.string().find("2.h5") != std::string::npos;
      model->trained_until = trained_until.at(is_second ? 1 : 0);
      return model;
    };
    return Recall(*ReplayedPast::open(store_, loads, [&now] { return now; }), nullptr, {});
  }
};

TEST_F(ReplayedModels, PredictByWhatWasTrainedBeforeThatMoment) {
  make_store(10, false);
  const auto model = temporary_file(store_, ".model");
  ASSERT_OK(replace_file(*model, as_bytes("weights")));
  const idf::Data value = example_snapshot(example_entity(), 9).instances[0].data;
  Latent latent = BytesEncoder().encode({&value, 1})->front();
  const std::vector<LatentSnapshot> latents{
      {example_time(9), 2, {{std::move(latent), example_metadata(9), {2.0, 0.25}}}}};
  ASSERT_OK(publish_model(store_, example_entity(), 2, *model, latents));
  Time now = example_time(5);
  Recall recall = replay(now, {example_time(4), example_time(7)});
  const auto engine = [&] {
    const auto engines = recall.engines(example_entity());
    EXPECT_OK(engines);
    return std::string(engines->front().predictor->name()) + " " + engines->front().model;
  };
  EXPECT_EQ(engine(), "counting Vision/RGB/head/cam v1");
  now = example_time(8);
  EXPECT_EQ(engine(), "counting Vision/RGB/head/cam v2");
  now = example_time(3);
  EXPECT_EQ(engine(), "copy-last ");
}

TEST_F(ReplayedModels, ThatDoNotTellWhatTheyWereTrainedOnDoNotPredict) {
  make_store(10, true);
  Time now = example_time(9);
  Recall recall = replay(now, {std::nullopt, std::nullopt});
  EXPECT_EQ(recall.engines(example_entity())->front().predictor->name(), "copy-last");
  // They decode what they coded all the same.
  now = example_time(6) + Duration(2);
  const auto latest = recall.query(ask("latest, all"));
  ASSERT_OK(latest);
  const auto& snapshots = latest->entities()[0]->snapshots;
  ASSERT_EQ(snapshots.size(), 7u);
  EXPECT_EQ(snapshots.back().source, Source::kReconstructed);
}

TEST(EntityArrivals, GoesThroughAllInTheOrderOfTheirArrival) {
  std::mt19937 random(11);
  for (int round = 0; round < 200; ++round) {
    std::vector<Time> times, arrived;
    std::set<Arrival> expected;
    for (int64_t i = 0; i < 20; ++i) {
      times.push_back(at_ms(i));
      arrived.push_back(at_ms(static_cast<int64_t>(random() % (round % 2 == 0 ? 5 : 100))));
      expected.insert({arrived.back(), times.back()});
    }
    const EntityArrivals arrivals(times, arrived);
    std::vector<Arrival> order;
    for (auto next = arrivals.next({Time::min(), Time::min()}); next; next = arrivals.next(*next))
      order.push_back(*next);
    EXPECT_EQ(order, std::vector(expected.begin(), expected.end()));
  }
}

/// A recorder that is given old times stamps arrivals with the time at which it runs.
TEST(ReplayedPast, TakesWhatArrivedYearsLaterForImported) {
  const ScratchDirectory scratch;
  std::vector<Snapshot> all;
  for (int64_t i = 0; i < 10; ++i) {
    const InstanceMetadata metadata{{}, {}, at_ms(1'000'000'000), "test", 1.0f};
    all.push_back({example_entity(), at_ms(i * 100), {{idf::Dict{{"x", 1.0}}, metadata}}});
  }
  write(scratch / "all", all, 1);
  Time now = at_ms(450);
  const auto past = *ReplayedPast::open(scratch / "all", nullptr, [&now] { return now; });
  const auto there = past->of(example_entity());
  ASSERT_OK(there);
  EXPECT_EQ(*(*there)->last(), at_ms(400));
  EXPECT_TRUE((*past->arrivals(example_entity()))->is_in_time());
}

TEST(OverlaidPast, HasWhatWasCommittedOverWhatWasRecorded) {
  const ScratchDirectory scratch;
  std::mt19937 random(1);
  write(scratch / "all", lived(random), 1);
  Time now = at_ms(1500);
  auto memory = *WorkingMemory::create({.mode = StoreMode::kLatest}, [&now] { return now; });
  Recall recall(std::make_unique<OverlaidPast>(
      "replay", *memory, *ReplayedPast::open(scratch / "all", nullptr, [&now] { return now; })));
  const auto ask = [&recall](const std::string& text) {
    auto answer = recall.query(*Query::parse(text));
    EXPECT_OK(answer);
    return *std::move(answer);
  };
  const MemoryId cam = example_entity("cam0");
  const MemoryId plan = *MemoryId::parse("Plans/a/b/plan");
  ASSERT_OK(memory->commit({{{cam, at_ms(1400), {{idf::Dict{{"x", 0.5}}, {}}}},
                             {plan, at_ms(1450), {{idf::Dict{{"x", 0.5}}, {}}}}}}));
  const QueryResult latest = ask(".* @ latest");
  EXPECT_EQ(latest.entities().size(), size_t{kEntities} + 1);
  const QueryResult all = ask(cam.to_string() + " @ all");
  EXPECT_EQ(all.entities()[0]->snapshots.size(), 16u);
  EXPECT_EQ(*all.entities()[0]->find(at_ms(1400))->instances[0].data.at("x"), idf::Data(0.5));
  const QueryResult planned = ask(plan.to_string() + " @ latest");
  EXPECT_EQ(planned.entities()[0]->snapshots[0].time, at_ms(1450));
}

}  // namespace
}  // namespace engram::ltm
