// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/record_reflection.h"

#include <gmock/gmock.h>

#include "tests/ltm/reflection/example_arm.h"

namespace engram::ltm {
namespace {

const char* const kAllFindings = "Reflection/Findings/engram/all";

Snapshot latest(const std::filesystem::path& store, const std::string& entity) {
  const auto reader = StoreReader::open(store);
  EXPECT_OK(reader);
  const MemoryId id = ExampleArm::id(entity);
  const auto index = (*reader)->index(id);
  EXPECT_OK(index);
  return (*reader)->read_recorded(id, (*index)->back()).value();
}

TEST(RecordReflection, TheStoreCanBeAskedAboutIt) {
  ExampleArm arm;
  arm.change(300, 301, 0, [](int, double) { return NAN; });
  const Reflection found = arm.reflect();
  ASSERT_OK(record_reflection(arm.store(), found));
  const Snapshot findings = latest(arm.store(), kAllFindings);
  ASSERT_EQ(findings.instances.size(), found.findings.size());
  const idf::Data& first = findings.instances[0].data;
  EXPECT_EQ(*first.at("kind"), idf::Data("not-finite"));
  EXPECT_EQ(*first.at("first_snapshot"), ExampleArm::id().at(ExampleArm::arm_time(300)).to_data());
  const Snapshot entities = latest(arm.store(), "Reflection/Summary/entities/all");
  EXPECT_EQ(*entities.instances[0].data.at("snapshots"), idf::Data(int64_t{2000}));
}

TEST(RecordReflection, SaysThatNothingWasFoundAndIsNotLookedAtItself) {
  ExampleArm arm;
  const Reflection found = arm.reflect();
  ASSERT_OK(record_reflection(arm.store(), found));
  EXPECT_EQ(*latest(arm.store(), kAllFindings).instances[0].data.at("kind"), idf::Data("none"));
  const auto again = reflect(arm.store());
  ASSERT_OK(again);
  EXPECT_EQ(again->entities.size(), 1u);
}

TEST(RecordReflection, ValuesAreOfTheirTypes) {
  Reflection reflection;
  reflection.chains.push_back({{"pick failure"}, 2});
  reflection.skills.push_back({"pick", 0, {SuccessRate{"all"}}});
  reflection.entities.push_back({ExampleArm::id()});
  reflection.findings.push_back({ReflectionKind::kGap, Severity::kNote, ExampleArm::id()});
  const Commit commit = to_commit(reflection, ExampleArm::arm_time(0));
  ASSERT_OK(commit.check());
  SegmentTypes types;
  for (const auto& [segment, type] : reflection_types()) ASSERT_OK(types.declare(segment, type));
  ASSERT_EQ(commit.updates.size(), 4u);
  for (const EntityUpdate& update : commit.updates)
    EXPECT_THAT(idf::check(update.instances[0].data, *types.of_entity(update.entity)),
                ::testing::IsEmpty())
        << update.entity.to_string();
}

}  // namespace
}  // namespace engram::ltm
