// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/stored_context.h"

#include "ltm/context/read_context.h"
#include "tests/ltm/recall/small_world.h"

namespace engram::ltm {
namespace {

/// The contexts of all entities of a world.
SegmentContexts contexts_of(const SmallWorld& world) {
  std::map<MemoryId, ContextReader> readers;
  for (const Snapshot& snapshot : world.snapshots()) {
    std::vector<InstanceResult> instances;
    for (const Instance& instance : snapshot.instances) {
      instances.emplace_back().data = instance.data;
      instances.back().index = static_cast<int32_t>(instances.size() - 1);
    }
    readers.try_emplace(snapshot.entity, std::nullopt).first->second.add(snapshot.time, instances);
  }
  SegmentContexts contexts;
  for (auto& [entity, reader] : readers) contexts.emplace_back(entity, std::move(reader).take());
  return contexts;
}

TEST(StoredContext, IsReadAsItWasPacked) {
  const SegmentContexts contexts = contexts_of(SmallWorld(1, 50));
  ASSERT_EQ(contexts.size(), 5);
  const auto bytes = pack_contexts(contexts);
  const auto again = unpack_contexts(bytes);
  ASSERT_OK(again);
  EXPECT_TRUE(*again == contexts);
  for (const auto& [entity, context] : contexts) {
    const auto one = unpack_context(bytes, entity);
    ASSERT_OK(one);
    ASSERT_TRUE(one->has_value());
    EXPECT_TRUE(**one == context) << entity.to_string();
  }
  const auto none = unpack_context(bytes, example_entity("nobody"));
  ASSERT_OK(none);
  EXPECT_FALSE(none->has_value());
}

TEST(StoredContext, IsRefusedWhereItIsDamaged) {
  const SegmentContexts contexts = contexts_of(SmallWorld(1, 20));
  const auto bytes = pack_contexts(contexts);
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(unpack_contexts(std::span(bytes).first(size)).status().code(), StatusCode::kDataLoss);
  // What was packed without a check is refused, because others read without one.
  const auto is_refused = [&contexts](auto&& damage) {
    SegmentContexts damaged = contexts;
    for (auto& [entity, context] : damaged) damage(context);
    return unpack_contexts(pack_contexts(damaged)).status().code() == StatusCode::kDataLoss;
  };
  EXPECT_TRUE(is_refused([](EntityContext& c) { std::swap(c.times.front(), c.times.back()); }));
  EXPECT_TRUE(is_refused([](EntityContext& c) { c.times.pop_back(); }));
  EXPECT_TRUE(is_refused([](EntityContext& c) { c.frames.clear(); }));
  EXPECT_TRUE(is_refused([](EntityContext& c) { c.targets.clear(); }));
  EXPECT_TRUE(is_refused([](EntityContext& c) {
    if (!c.places.position.empty()) c.places.position.pop_back();
  }));
  EXPECT_TRUE(is_refused([](EntityContext& c) {
    if (!c.places.position.empty()) c.places.position[0] = std::nan("");
  }));
  EXPECT_TRUE(is_refused([](EntityContext& c) {
    if (!c.cameras.calibration.empty()) c.cameras.calibration[0] = 1'000'000;
  }));
  EXPECT_TRUE(is_refused([](EntityContext& c) {
    if (!c.cameras.calibration.empty()) c.cameras.calibration[0] = -1;
  }));
  EXPECT_TRUE(is_refused([](EntityContext& c) {
    if (!c.cameras.instance.empty()) c.cameras.instance[0] = -1;
  }));
  // What a stranger sends may be small and take much.
  const auto& [entity, context] = contexts.back();
  EXPECT_EQ(unpack_context(bytes, entity, 100).status().code(), StatusCode::kDataLoss);
  EXPECT_OK(unpack_context(bytes, entity, 1'000'000));
  EXPECT_TRUE(is_refused([](EntityContext& c) {
    if (!c.visibility.empty()) c.visibility[0] = static_cast<EntityContext::Visibility>(7);
  }));
  EXPECT_TRUE(is_refused([](EntityContext& c) {
    if (!c.spans.ended.empty()) c.spans.ended.pop_back();
  }));
}

TEST(ContextMerger, JoinsWhatWasSplit) {
  for (auto& [entity, whole] : contexts_of(SmallWorld(2, 60))) {
    // Every snapshot from one of three parts, each of which has its own names.
    std::array<ContextMerger, 3> parts;
    std::vector<std::pair<size_t, uint32_t>> places;
    std::array<uint32_t, 3> counts{};
    for (uint32_t i = 0; i < whole.times.size(); ++i) {
      const size_t part = (i * 7 + i / 5) % 3;
      parts[part].add(whole, i);
      places.emplace_back(part, counts[part]++);
    }
    const std::array<EntityContext, 3> split = {
        std::move(parts[0]).take(), std::move(parts[1]).take(), std::move(parts[2]).take()};
    ContextMerger merger;
    for (const auto& [part, row] : places) merger.add(split[part], row);
    const EntityContext merged = std::move(merger).take();
    EXPECT_EQ(merged.times, whole.times);
    EXPECT_EQ(merged.places.position, whole.places.position) << entity.to_string();
    EXPECT_EQ(merged.cameras.orientation, whole.cameras.orientation);
    EXPECT_EQ(merged.links.time, whole.links.time);
    EXPECT_EQ(merged.spans, whole.spans);
    EXPECT_TRUE(merged.visibility == whole.visibility);
    for (size_t i = 0; i < whole.links.size(); ++i)
      EXPECT_EQ(merged.targets[merged.links.target[i]], whole.targets[whole.links.target[i]]);
    EXPECT_EQ(merged.cameras.calibration, whole.cameras.calibration);
  }
}

TEST(FrameInName, IsBetweenPoseAndTheThing) {
  EXPECT_EQ(frame_in_name("pose_world_camera"), "world");
  EXPECT_EQ(frame_in_name("pose_world_left_hand"), "world");
  EXPECT_EQ(frame_in_name("pose"), "");
  EXPECT_EQ(frame_in_name("pose_world"), "");
  EXPECT_EQ(frame_in_name("position_world_x"), "");
}

TEST(ContextReader, ReadsPlacesAsRosWritesThem) {
  const auto number = [](double x) { return idf::Data(x); };
  const idf::Data value = idf::Dict{
      {"header", idf::Dict{{"frame_id", "/map"}}},
      {"pose",
       idf::Dict{
           {"position", idf::Dict{{"x", number(1)}, {"y", number(2)}, {"z", number(3)}}},
           {"orientation",
            idf::Dict{{"x", number(0)}, {"y", number(0)}, {"z", number(1)}, {"w", number(0)}}}}}};
  std::vector<InstanceResult> instances(1);
  instances[0].data = value;
  ContextReader reader(std::nullopt);
  reader.add(example_time(0), instances);
  const EntityContext context = std::move(reader).take();
  ASSERT_EQ(context.places.size(), 1);
  EXPECT_EQ(context.frames.at(context.places.frame[0]), "map");
  EXPECT_EQ(context.places.position, (std::vector<double>{1, 2, 3}));
}

TEST(ContextReader, SurvivesValuesThatAreNested) {
  idf::Data value = idf::Dict{{"x", 1.0}};
  for (int i = 0; i < 200; ++i) value = idf::Dict{{"pose_world_x", std::move(value)}};
  std::vector<InstanceResult> instances(1);
  instances[0].data = std::move(value);
  ContextReader reader(std::nullopt);
  reader.add(example_time(0), instances);
  EXPECT_EQ(std::move(reader).take().places.size(), 0);
}

}  // namespace
}  // namespace engram::ltm
