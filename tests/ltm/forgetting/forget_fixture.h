// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "ltm/forgetting/plan_forgetting.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

/// A store of small snapshots, one second apart, and plans of it.
class ForgetFixture : public ::testing::Test {
 protected:
  ForgetFixture() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  static Time second(int64_t index) { return time_from_ns(index * 1'000'000'000); }

  static Snapshot numbered(const std::string& name, int64_t index, double x, float confidence = 1) {
    InstanceMetadata metadata{second(index), second(index), second(index), "arm", confidence};
    return {example_entity(name), second(index), {{idf::Dict{{"x", x}}, std::move(metadata)}}};
  }

  /// Noise that no codec makes smaller.
  static Snapshot noisy(const std::string& name, int64_t index, size_t bytes) {
    std::mt19937 random(static_cast<uint32_t>(index));
    std::vector<uint8_t> noise(bytes);
    for (uint8_t& each : noise) each = static_cast<uint8_t>(random());
    const auto count = static_cast<int64_t>(bytes);
    Snapshot snapshot = numbered(name, index, 0);
    snapshot.instances.front().data =
        idf::Dict{{"noise", idf::NdArray::take({count}, std::move(noise))}};
    return snapshot;
  }

  /// Seals `count` noisy pictures of an entity from second `first` on, as groups with loss. Content
  /// is not compared.
  void seal_groups(const std::string& name, int64_t first, int64_t count) {
    const PackOptions options{.rules = {{.kind = MediumKind::kImage, .codec = "h264:group=10"}}};
    StoreWriter::Options writing{.durability = Durability::kNone};
    writing.seal_rules = [&options](const MemoryId&) { return *SealRules::create(options); };
    const auto writer = *StoreWriter::open(store_, writing);
    for (int64_t i = first; i < first + count; ++i) {
      Snapshot snapshot = noisy(name, i, 128 * 128 * 3);
      idf::Data& noise = *snapshot.instances.front().data.at("noise");
      noise = *idf::NdArray::create(idf::ElementType::kUInt8, {128, 128, 3},
                                    noise.get<idf::NdArray>().buffer());
      PackedSnapshot packed = pack_snapshot(snapshot);
      packed.instances[0].value = *pack(snapshot.instances[0].data, options);
      ASSERT_OK(writer->append({packed}, nullptr));
    }
    ASSERT_OK(writer->seal());
  }

  void append(const std::vector<Snapshot>& snapshots, bool is_sealed = true) {
    const auto writer = *StoreWriter::open(store_, {.durability = Durability::kNone});
    for (const Snapshot& snapshot : snapshots) {
      ASSERT_OK(writer->append({pack_snapshot(snapshot)}, nullptr));
      content_[snapshot.entity][snapshot.time] = snapshot;
    }
    if (is_sealed) ASSERT_OK(writer->seal());
  }

  /// `count` snapshots of an entity from second `first` on, x = `each` * index.
  void seal_numbers(const std::string& name, int64_t first, int64_t count, double each = 1) {
    std::vector<Snapshot> snapshots;
    for (int64_t i = first; i < first + count; ++i)
      snapshots.push_back(numbered(name, i, each * static_cast<double>(i)));
    append(snapshots);
  }

  ForgetContext context() {
    ForgetContext context = *ForgetContext::of(store_);
    context.now = now_;
    return context;
  }

  Result<ForgetPlan> plan(const ForgetOptions& options) {
    Recall recall(*StoreReader::open(store_), {});
    ForgetSource source(recall, accesses_);
    return plan_forgetting(source, options, context());
  }

  Result<ForgetPlan> plan_of(const std::vector<std::string>& texts,
                             const ForgetProtection& protection = {}) {
    Recall recall(*StoreReader::open(store_), {});
    ForgetSource source(recall, accesses_);
    ENGRAM_ASSIGN_OR_RETURN(const ForgetSet chosen, find_forget_targets(recall, texts));
    return plan_forgetting_of(source, chosen, protection, context());
  }

  /// The seconds that a plan takes of an entity.
  static std::vector<int64_t> gone(const Result<ForgetPlan>& plan,
                                   const std::string& name = "cam") {
    EXPECT_OK(plan);
    std::vector<int64_t> seconds;
    if (!plan.ok()) return seconds;
    const auto entity = plan->entities.find(example_entity(name));
    if (entity == plan->entities.end()) return seconds;
    for (const Time time : entity->second.gone) seconds.push_back(to_ns(time) / 1'000'000'000);
    return seconds;
  }

  static ForgetRule older_than(Duration duration) {
    ForgetRule rule;
    rule.age = AgePolicy::Options{duration};
    return rule;
  }

  /// The store holds what was written but for what was to go.
  void expect_content_without(const ForgetSet& gone) {
    const auto reader = *StoreReader::open(store_);
    for (const auto& [entity, snapshots] : content_) {
      std::vector<Snapshot> expected;
      const auto times = gone.find(entity);
      for (const auto& [time, snapshot] : snapshots)
        if (times == gone.end() || !times->second.contains(time)) expected.push_back(snapshot);
      const bool is_there = std::ranges::count(reader->entities(), entity) > 0;
      const auto found = is_there ? read_all(*reader, entity) : std::vector<Snapshot>();
      ASSERT_OK(found);
      EXPECT_EQ(*found, expected) << entity.to_string();
    }
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
  std::map<MemoryId, std::map<Time, Snapshot>> content_;
  AccessTable accesses_;
  Time now_ = second(1000);
};

}  // namespace engram::ltm
