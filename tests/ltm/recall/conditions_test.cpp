// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/stored_context.h"
#include "ltm/recall/index_store.h"
#include "ltm/recall/recall.h"
#include "ltm/store/segment_index.h"
#include "tests/ltm/recall/small_world.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

constexpr int kWorldSteps = 120;

/// What a random condition asks, and which times brute force finds.
struct RandomQuestion {
  std::string text;
  std::vector<Time> expected;
};

template <typename T, typename Meets>
std::vector<Time> brute_force(const std::vector<T>& all, bool is_negated, const Meets& meets) {
  std::vector<Time> times;
  for (const T& one : all)
    if (meets(one) != is_negated) times.push_back(one.time);
  return times;
}

RandomQuestion random_question(SmallWorld& world) {
  using World = SmallWorld;
  const auto one = world.below(2);
  const auto& things = world.things[one];
  const auto& others = world.things[1 - one];
  const std::string thing = World::thing(static_cast<int>(one)).to_string();
  const std::string other = World::thing(static_cast<int>(1 - one)).to_string();
  const std::string camera = World::camera().to_string();
  const bool is_negated = world.chance(0.2);
  const std::string all = " @ all " + std::string(is_negated ? "not " : "");
  const double radius = std::abs(world.angle());
  switch (world.below(7)) {
    case 0: {
      const auto point = world.point();
      return {thing + all + fmt::format("near {},{},{} {}m", point[0], point[1], point[2], radius),
              brute_force(things, is_negated, [&](const World::Thing& at) {
                return World::distance(at.at, point) <= radius;
              })};
    }
    case 1:
      return {thing + all + "within " + other + fmt::format(" {}m", radius),
              brute_force(things, is_negated, [&](const World::Thing& at) {
                const auto* then = World::last_until(others, at.time);
                return then != nullptr && World::distance(at.at, then->at) <= radius;
              })};
    case 2: {
      const bool is_vain = world.chance(0.5);
      const bool is_any = world.chance(0.3);
      return {camera + all +
                  (is_any    ? "in-view "
                   : is_vain ? "in-vain "
                             : "seen-with ") +
                  thing,
              brute_force(world.looks, is_negated, [&](const World::Look& look) {
                const auto* then = World::last_until(things, look.time);
                if (then == nullptr) return false;
                if (is_any) return world.sees(look, then->at);
                return world.sees(look, then->at, then->image_index) && then->is_visible != is_vain;
              })};
    }
    case 3: {
      const bool is_any = world.chance(0.5);
      return {thing + all + (is_any ? "in-view " : "seen-with ") + camera,
              brute_force(things, is_negated, [&](const World::Thing& at) {
                for (const World::Look& look : world.looks)
                  if (to_ns(look.time) == at.image_ns)
                    return is_any ? world.sees(look, at.at)
                                  : at.is_visible && world.sees(look, at.at, at.image_index);
                return false;
              })};
    }
    case 4:
      return {thing + all + "while " + World::action().to_string(),
              brute_force(things, is_negated,
                          [&](const World::Thing& at) { return world.is_acting(at.time); })};
    case 5: {
      const auto& look = world.looks[world.below(world.looks.size())];
      const bool is_instance = world.chance(0.5);
      MemoryId target = World::camera().at(look.time);
      if (is_instance) target = target.instance(1);
      return {thing + all + "linked-to " + target.to_string(),
              brute_force(things, is_negated, [&](const World::Thing& at) {
                return at.image_ns == to_ns(look.time) && (!is_instance || at.image_index == 1);
              })};
    }
    default:
      return {World::thing(0).to_string() + all + "links-from " + World::action().to_string(),
              brute_force(world.things[0], is_negated, [&](const World::Thing& at) {
                return std::ranges::any_of(world.actions, [&](const World::Action& action) {
                  return action.object_ns == at.time;
                });
              })};
  }
}

std::vector<Time> times_of(const Result<QueryResult>& answer) {
  std::vector<Time> times;
  if (!answer.ok()) return times;
  for (const EntityResult* entity : answer->entities())
    for (const SnapshotResult& snapshot : entity->snapshots) times.push_back(snapshot.time);
  return times;
}

/// Records a world: two segments, and a rest in journals.
void record_world(const SmallWorld& world, const std::filesystem::path& store) {
  ASSERT_OK(create_store(store));
  const auto writer = StoreWriter::open(store, {});
  ASSERT_OK(writer);
  const std::vector<Snapshot> snapshots = world.snapshots();
  for (size_t i = 0; i < snapshots.size(); ++i) {
    ASSERT_OK((*writer)->append({pack_snapshot(snapshots[i])}, nullptr));
    if (i == snapshots.size() / 3 || i == 2 * snapshots.size() / 3) ASSERT_OK((*writer)->seal());
  }
}

std::unique_ptr<Recall> recall_of(const std::filesystem::path& store) {
  auto reader = StoreReader::open(store);
  EXPECT_OK(reader);
  return std::make_unique<Recall>(*std::move(reader), ModelLoader());
}

TEST(Conditions, AreMetAsBruteForceSays) {
  ScratchDirectory scratch;
  const auto path = scratch.path() / "store";
  SmallWorld world(3, kWorldSteps);
  record_world(world, path);
  // From values, and from indexes.
  for (const bool is_indexed : {false, true}) {
    if (is_indexed) {
      const auto indexed = index_store(path, {}, {}, {}, {});
      ASSERT_OK(indexed);
      EXPECT_EQ(indexed->segments, 2);
      const auto again = index_store(path, {}, {}, {}, {});
      ASSERT_OK(again);
      EXPECT_EQ(again->segments, 0);
    }
    const auto recall = recall_of(path);
    size_t found = 0;
    for (int round = 0; round < 5000; ++round) {
      const RandomQuestion question = random_question(world);
      const auto query = Query::parse("?ids " + question.text);
      ASSERT_OK(query);
      const auto answer = recall->query(*query);
      ASSERT_OK(answer);
      ASSERT_EQ(times_of(answer), question.expected) << question.text;
      found += question.expected.size();
    }
    EXPECT_GT(found, 10'000);
  }
}

TEST(Conditions, AreMetBeforeASelectorSelects) {
  ScratchDirectory scratch;
  const auto path = scratch.path() / "store";
  SmallWorld world(4, kWorldSteps);
  record_world(world, path);
  const auto recall = recall_of(path);
  for (int round = 0; round < 300; ++round) {
    RandomQuestion one = random_question(world);
    RandomQuestion other = random_question(world);
    const std::string entity = one.text.substr(0, one.text.find(" @"));
    if (!other.text.starts_with(entity + " @")) continue;
    // Both hold.
    std::vector<Time> both;
    std::ranges::set_intersection(one.expected, other.expected, std::back_inserter(both));
    const std::string conditions = one.text.substr(one.text.find("@ all") + 5) +
                                   other.text.substr(other.text.find("@ all") + 5);
    const auto ask = [&](const std::string& selector) {
      const auto query = Query::parse("?ids " + entity + " @ " + selector + conditions);
      EXPECT_OK(query);
      return times_of(recall->query(*query));
    };
    EXPECT_EQ(ask("all"), both);
    const size_t last = both.size() < 3 ? both.size() : 3;
    EXPECT_EQ(ask("latest:3"),
              std::vector<Time>(both.end() - static_cast<ptrdiff_t>(last), both.end()));
    if (both.empty()) continue;
    EXPECT_EQ(ask("before:" + to_string(both.back())),
              both.size() == 1 ? std::vector<Time>() : std::vector<Time>{both[both.size() - 2]});
    EXPECT_EQ(ask(to_string(both.front())), std::vector<Time>{both.front()});
    // Nothing of the future meets a condition.
    EXPECT_TRUE(ask(to_string(example_time(10 * kWorldSteps))).empty());
  }
}

TEST(Conditions, OfPartsAreThoseOfTheWhole) {
  ScratchDirectory scratch;
  const auto path = scratch.path() / "store";
  SmallWorld world(5, kWorldSteps);
  record_world(world, path);
  const auto recall = recall_of(path);
  for (int round = 0; round < 50; ++round) {
    const RandomQuestion question = random_question(world);
    auto cursor = recall->begin(*Query::parse(question.text), {});
    ASSERT_OK(cursor);
    std::vector<Time> times;
    while (!cursor->is_done()) {
      const auto part = recall->next(*cursor, 1000);
      ASSERT_OK(part);
      for (const RecalledEntity& entity : part->entities)
        for (const RecalledSnapshot& snapshot : entity.snapshots)
          times.push_back(snapshot.answer.time);
    }
    EXPECT_EQ(times, question.expected) << question.text;
  }
}

TEST(Conditions, AreAnsweredWithoutAnIndexThatIsDamaged) {
  ScratchDirectory scratch;
  const auto path = scratch.path() / "store";
  SmallWorld world(6, 60);
  record_world(world, path);
  ASSERT_OK(index_store(path, {}, {}, {}, {}));
  const auto reader = StoreReader::open(path);
  ASSERT_OK(reader);
  for (const SegmentInfo& segment : (*reader)->manifest().segments)
    ASSERT_OK(
        edit_segment_index(path, segment, kContextIndex, [](std::span<const std::byte> there) {
          std::vector<std::byte> damaged(there.begin(), there.end());
          damaged[damaged.size() / 2] ^= std::byte{0x40};
          return damaged;
        }));
  const auto recall = recall_of(path);
  for (int round = 0; round < 200; ++round) {
    const RandomQuestion question = random_question(world);
    EXPECT_EQ(times_of(recall->query(*Query::parse("?ids " + question.text))), question.expected);
  }
}

/// A camera that looks at a wall 3 m away, and depth images of it.
void record_depths(const std::filesystem::path& store) {
  ASSERT_OK(create_store(store));
  const auto writer = StoreWriter::open(store, {});
  ASSERT_OK(writer);
  const auto id = [](const std::string& text) { return *MemoryId::parse(text); };
  const auto pose = [](double z) {
    return idf::Data(idf::Dict{{"position", idf::NdArray::take<double>({3}, {0, 0, z})},
                               {"orientation", idf::NdArray::take<double>({4}, {1, 0, 0, 0})}});
  };
  ASSERT_OK((*writer)->declare(
      id("Vision/Depth"),
      idf::Type::object("DepthView", {{"depth", idf::Type::image(idf::PixelType::kDepth16)},
                                      {"view", idf::Type::memory_link()}})));
  // Nothing before it, something 1 m away, nothing measured, its own surface, and no image at all.
  const std::vector<std::optional<uint16_t>> depths = {3000, 1000, 0, 1900, std::nullopt};
  for (size_t i = 0; i < depths.size(); ++i) {
    const Time time = example_time(static_cast<int64_t>(i));
    const MemoryId camera = id("Vision/RGB/head/camera");
    std::vector<PackedSnapshot> commit;
    commit.push_back(pack_snapshot({camera,
                                    time,
                                    {{idf::Dict{{"pose_world_camera", pose(0)},
                                                {"fx", 8.0},
                                                {"fy", 8.0},
                                                {"cx", 7.5},
                                                {"cy", 7.5},
                                                {"width", 16},
                                                {"height", 16}},
                                      {}}}}));
    commit.push_back(
        pack_snapshot({id("Objects/a/b/cup"),
                       time,
                       {{idf::Dict{{"pose_world_cup", pose(2)}, {"is_visible", false}}, {}}}}));
    if (depths[i]) {
      std::vector<uint16_t> pixels(16 * 16, *depths[i]);
      commit.push_back(
          pack_snapshot({id("Vision/Depth/head/camera"),
                         time,
                         {{idf::Dict{{"depth", idf::NdArray::take({16, 16, 1}, std::move(pixels))},
                                     {"view", camera.at(time).instance(0).to_string()}},
                           {}}}}));
    }
    ASSERT_OK((*writer)->append(commit, nullptr));
  }
}

TEST(Conditions, AskDepthImagesWhetherTheViewWasBlocked) {
  ScratchDirectory scratch;
  const auto path = scratch.path() / "store";
  record_depths(path);
  const auto recall = recall_of(path);
  const auto ask = [&recall](const std::string& text) {
    return times_of(recall->query(*Query::parse("?ids " + text)));
  };
  const std::vector<Time> all = {example_time(0), example_time(1), example_time(2), example_time(3),
                                 example_time(4)};
  std::vector<Time> in_vain = all;
  in_vain.erase(in_vain.begin() + 1);
  EXPECT_EQ(ask("Vision/RGB/head/camera @ all in-view Objects/a/b/cup"), all);
  EXPECT_EQ(ask("Vision/RGB/head/camera @ all in-vain Objects/a/b/cup"), in_vain);
  EXPECT_EQ(ask("Objects/a/b/cup @ all in-vain Vision/RGB/head/camera"), in_vain);
  EXPECT_TRUE(ask("Vision/RGB/head/camera @ all seen-with Objects/a/b/cup").empty());
}

/// Sees nothing of one entity, and of the others nothing before a time.
class PartialView final : public View {
 public:
  PartialView(MemoryId hidden, Time from) : hidden_(std::move(hidden)), from_(from) {}
  [[nodiscard]] Sight of(const MemoryId& entity) const override {
    Sight sight;
    if (entity == hidden_) return sight;
    sight.times.add({from_, Time::max()});
    sight.exact = TimeWindows::all();
    return sight;
  }

 private:
  const MemoryId hidden_;
  const Time from_;
};

TEST(Conditions, TellNothingOfWhatAViewDoesNotSee) {
  ScratchDirectory scratch;
  const auto path = scratch.path() / "store";
  SmallWorld world(7, kWorldSteps);
  record_world(world, path);
  const auto recall = recall_of(path);
  const Time from = example_time(kWorldSteps / 2);
  Recall::Options options;
  options.view = std::make_shared<PartialView>(SmallWorld::action(), from);
  const auto hidden =
      recall->query(*Query::parse("?ids " + SmallWorld::thing(0).to_string() + " @ all while " +
                                  SmallWorld::action().to_string()),
                    options);
  EXPECT_EQ(hidden.status().code(), StatusCode::kNotFound);
  // The other thing is there since `from` only, so nothing is near its earlier places.
  const auto within =
      recall->query(*Query::parse("?ids " + SmallWorld::thing(0).to_string() + " @ all within " +
                                  SmallWorld::thing(1).to_string() + " 9m"),
                    options);
  std::vector<Time> expected;
  const auto first =
      std::ranges::find_if(world.things[1], [&](const auto& at) { return at.time >= from; });
  for (const auto& at : world.things[0])
    if (at.time >= first->time) expected.push_back(at.time);
  EXPECT_EQ(times_of(within), expected);
}

TEST(Conditions, ThatCannotBeToldAreErrors) {
  ScratchDirectory scratch;
  const auto path = scratch.path() / "store";
  SmallWorld world(8, 30);
  record_world(world, path);
  {
    const auto writer = StoreWriter::open(path, {});
    ASSERT_OK(writer);
    const idf::Data pose =
        idf::Dict{{"position", idf::NdArray::take<double>({3}, {0, 0, 0})},
                  {"orientation", idf::NdArray::take<double>({4}, {1, 0, 0, 0})}};
    ASSERT_OK(
        (*writer)->append({pack_snapshot({*MemoryId::parse("a/b/c/frameless"),
                                          example_time(1),
                                          {{idf::Dict{{"pose", pose}}, {}}}}),
                           pack_snapshot({*MemoryId::parse("a/b/c/mapped"),
                                          example_time(1),
                                          {{idf::Dict{{"frame_id", "/map"}, {"pose", pose}}, {}}}}),
                           packed_example(1, *MemoryId::parse("a/b/c/numbers"))},
                          nullptr));
  }
  const auto recall = recall_of(path);
  const std::string thing = SmallWorld::thing(0).to_string();
  const std::string camera = SmallWorld::camera().to_string();
  const std::tuple<std::string, StatusCode, std::string> cases[] = {
      {"a/b/c/numbers @ all near 0,0,0 1m", StatusCode::kFailedPrecondition, "has no place"},
      {"a/b/c/frameless @ all near 0,0,0 1m", StatusCode::kFailedPrecondition, "name no frame"},
      {thing + " @ all near 0,0,0 1m in map", StatusCode::kFailedPrecondition, "in frame 'map'"},
      {thing + " @ all within a/b/c/frameless 1m", StatusCode::kFailedPrecondition,
       "name no frame"},
      {thing + " @ all within a/b/c/mapped 1m", StatusCode::kFailedPrecondition,
       "no frame in common"},
      {thing + " @ all in-view " + SmallWorld::thing(1).to_string(),
       StatusCode::kFailedPrecondition, "is a camera"},
      {camera + " @ all in-vain a/b/c/mapped", StatusCode::kFailedPrecondition,
       "no frame in common"},
      {thing + " @ all while " + camera, StatusCode::kFailedPrecondition, "starts and ends"},
      {thing + " @ all while a/b/c/nobody", StatusCode::kNotFound, "a/b/c/nobody"},
      {thing + " @ all links-from a/b/c/nobody", StatusCode::kNotFound, "a/b/c/nobody"}};
  for (const auto& [text, code, message] : cases) {
    const auto answer = recall->query(*Query::parse("?ids " + text));
    EXPECT_EQ(answer.status().code(), code) << text;
    EXPECT_NE(answer.status().message().find(message), std::string::npos)
        << text << ": " << answer.status().message();
  }
  // Of many entities those without a place just meet nothing.
  const auto all = recall->query(*Query::parse("?ids .* @ all near 0,0,0 1m in map"));
  ASSERT_OK(all);
  EXPECT_EQ(times_of(all), std::vector<Time>{example_time(1)});
}

}  // namespace
}  // namespace engram::ltm
