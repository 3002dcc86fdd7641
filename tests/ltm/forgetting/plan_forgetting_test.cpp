// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/plan_forgetting.h"

#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "tests/ltm/forgetting/forget_fixture.h"

namespace engram::ltm {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Seconds = std::chrono::seconds;

class PlanForgetting : public ForgetFixture {
 protected:
  static ForgetOptions all_old() {
    ForgetOptions options;
    options.rules = {older_than(Seconds(0))};
    return options;
  }

  static Snapshot linking(const std::string& name, int64_t index, const MemoryId& to) {
    Snapshot snapshot = numbered(name, index, 0);
    snapshot.instances.front().data = idf::Dict{{"seen", to.to_string()}};
    return snapshot;
  }
};

TEST_F(PlanForgetting, TheNewestOfEachEntityStaysByDefault) {
  seal_numbers("cam", 0, 3);
  seal_numbers("other", 5, 1);
  const auto made = plan(all_old());
  EXPECT_THAT(gone(made), ElementsAre(0, 1));
  EXPECT_THAT(gone(made, "other"), IsEmpty());
  ForgetOptions two = all_old();
  two.protection.newest = 2;
  EXPECT_THAT(gone(plan(two)), ElementsAre(0));
}

TEST_F(PlanForgetting, WhatIsYoungStays) {
  seal_numbers("cam", 0, 10);
  ForgetOptions options = all_old();
  options.protection.younger_than = Seconds(4);
  now_ = second(9);
  EXPECT_THAT(gone(plan(options)), ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST_F(PlanForgetting, ProtectedEntitiesStayWhole) {
  seal_numbers("cam", 0, 3);
  seal_numbers("other", 0, 3);
  ForgetOptions options = all_old();
  options.protection.entities = {*EntityPattern::parse("Vision/RGB/head/cam")};
  const auto made = plan(options);
  EXPECT_THAT(gone(made), IsEmpty());
  EXPECT_THAT(gone(made, "other"), ElementsAre(0, 1));
}

TEST_F(PlanForgetting, WhatIsNotSealedYetStaysAndIsCounted) {
  seal_numbers("cam", 0, 3);
  append({numbered("cam", 3, 1), numbered("cam", 4, 1), numbered("cam", 1, 7)}, false);
  const auto made = plan(all_old());
  EXPECT_THAT(gone(made), ElementsAre(0, 2)) << "second 1 has an update in the journal";
  EXPECT_EQ(made->unsealed(), 3u);
}

TEST_F(PlanForgetting, EverySnapshotGoesForOneReason) {
  seal_numbers("cam", 0, 5);
  ForgetOptions options = all_old();
  options.rules = {older_than(Seconds(998)), older_than(Seconds(997))};
  options.rules.push_back(older_than(Seconds(998)));
  const auto made = plan(options);
  const auto& entity = made->entities.at(example_entity());
  EXPECT_EQ(entity.reasons,
            (std::map<std::string, uint64_t>{{"older than 997s", 1}, {"older than 998s", 2}}));
  EXPECT_EQ(entity.stays, 2u);
}

TEST_F(PlanForgetting, LinkedSnapshotsStayWithAllThatTheyLeadTo) {
  const MemoryId cam = example_entity("cam"), grasp = example_entity("grasp");
  seal_numbers("cam", 0, 6);
  append({linking("grasp", 0, cam.at(second(0))), linking("grasp", 1, cam.at(second(1))),
          linking("grasp", 9, grasp.at(second(0)).instance(0))});
  const auto unprotected = plan(all_old());
  EXPECT_THAT(gone(unprotected), SizeIs(5));
  ForgetOptions options = all_old();
  options.protection.linked = true;
  const auto made = plan(options);
  // The newest grasp stays, and names the one at 0, which names an image.
  EXPECT_THAT(gone(made, "grasp"), ElementsAre(1));
  EXPECT_THAT(gone(made), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(made->entities.at(cam).shielded, 1u);
  EXPECT_EQ(made->entities.at(grasp).shielded, 1u);
}

TEST_F(PlanForgetting, LinksToWhatIsNotThereDoNoHarm) {
  seal_numbers("cam", 0, 2);
  append({linking("grasp", 0, example_entity("nobody").at(second(0))),
          linking("grasp", 1, example_entity("cam").at(second(99)))});
  ForgetOptions options = all_old();
  options.protection.linked = true;
  EXPECT_THAT(gone(plan(options)), ElementsAre(0));
}

TEST_F(PlanForgetting, AQuotaTakesTheOldestOfAllEntities) {
  for (int64_t i = 0; i < 4; ++i) {
    append({noisy("cam", 2 * i, 40'000), noisy("other", 2 * i + 1, 40'000)});
  }
  ForgetOptions options;
  options.max_bytes = context().store_bytes - 60'000;
  const auto made = plan(options);
  EXPECT_THAT(gone(made), ElementsAre(0));
  EXPECT_THAT(gone(made, "other"), ElementsAre(1));
  EXPECT_EQ(made->missing_bytes, 0u);
  EXPECT_EQ(made->entities.at(example_entity()).reasons.begin()->first, "quota: oldest");
}

TEST_F(PlanForgetting, AQuotaTakesWhatRulesNameFirst) {
  for (int64_t i = 0; i < 6; ++i) append({numbered("cam", i, 1), noisy("other", i, 40'000)});
  ForgetOptions options;
  ForgetRule unimportant;
  unimportant.match = *EntityPattern::parse("Vision/RGB/head/cam");
  unimportant.importance = ImportancePolicy::Options{};
  options.first = {unimportant};
  options.max_bytes = context().store_bytes - 30'000;
  const auto made = plan(options);
  EXPECT_THAT(gone(made), ElementsAre(0, 1, 2, 3, 4)) << "all that may go, before any other";
  EXPECT_THAT(gone(made, "other"), ElementsAre(0));
}

TEST_F(PlanForgetting, AMetQuotaTakesNothing) {
  seal_numbers("cam", 0, 5);
  ForgetOptions options;
  options.max_bytes = context().store_bytes;
  options.min_free_disk_bytes = 1;
  EXPECT_EQ(plan(options)->snapshots(), 0u);
}

TEST_F(PlanForgetting, GroupsOfImagesFreeNothingUntilTheyGoWhole) {
  seal_groups("cam", 0, 20);
  seal_groups("cam", 20, 20);
  ForgetOptions half = all_old();
  half.protection.younger_than = Seconds(986);
  const auto cut = plan(half);
  ASSERT_THAT(gone(cut), SizeIs(15));
  EXPECT_EQ(cut->freed_bytes, 0u);
  EXPECT_EQ(cut->entities.at(example_entity()).freed_bytes, 0u);
  ForgetOptions options;
  options.max_bytes = context().store_bytes - 40'000;
  const auto made = plan(options);
  EXPECT_THAT(gone(made), SizeIs(20)) << "the first segment whole, and no more";
  EXPECT_EQ(made->missing_bytes, 0u);
  ASSERT_OK(forget_snapshots(store_, made->to_set()));
  EXPECT_LE(context().store_bytes, *options.max_bytes) << "the plan keeps its word";
}

TEST_F(PlanForgetting, FreeDiskSpaceIsAQuotaToo) {
  for (int64_t i = 0; i < 4; ++i) append({noisy("cam", i, 40'000)});
  Recall recall(*StoreReader::open(store_), {});
  ForgetSource source(recall, accesses_);
  ForgetContext world = context();
  world.free_disk_bytes = 1'000'000;
  ForgetOptions options;
  options.min_free_disk_bytes = 1'030'000;
  EXPECT_THAT(gone(plan_forgetting(source, options, world)), ElementsAre(0));
}

TEST_F(PlanForgetting, LaterRoundsLookAtTheDirectoryAlone) {
  ForgetPlan first;
  first.store_bytes = 5000;
  first.free_disk_bytes = 1'000'000;
  ForgetOptions options = all_old();
  options.min_free_disk_bytes = 1'000'100;
  options.first = {older_than(Seconds(1))};
  EXPECT_EQ(quota_after(options, first).max_bytes, 4900u);
  EXPECT_TRUE(quota_after(options, first).rules.empty());
  EXPECT_FALSE(quota_after(options, first).min_free_disk_bytes.has_value());
  options.max_bytes = 4000;
  EXPECT_EQ(quota_after(options, first).max_bytes, 4000u);
  options.max_bytes.reset();
  options.min_free_disk_bytes = 2'000'000;
  EXPECT_EQ(quota_after(options, first).max_bytes, 0u);
  options.min_free_disk_bytes = 1000;
  EXPECT_FALSE(quota_after(options, first).max_bytes.has_value());
  EXPECT_OK(quota_after(options, first).validate());
}

TEST_F(PlanForgetting, AQuotaThatCannotBeMetSaysByHowMuch) {
  seal_numbers("cam", 0, 5);
  ForgetOptions options;
  options.max_bytes = 10;
  const auto made = plan(options);
  EXPECT_THAT(gone(made), SizeIs(4));
  EXPECT_GT(made->missing_bytes, 0u);
}

TEST_F(PlanForgetting, NamesIdsOfEveryLevelAndQueries) {
  seal_numbers("cam", 0, 4);
  seal_numbers("other", 0, 2);
  const std::string cam = example_entity().to_string();
  EXPECT_THAT(gone(plan_of({example_entity().at(second(2)).to_string()})), ElementsAre(2));
  EXPECT_THAT(gone(plan_of({example_entity().at(second(3)).instance(0).to_string()})),
              ElementsAre(3))
      << "the newest too: it was chosen";
  EXPECT_THAT(gone(plan_of({cam})), SizeIs(4));
  EXPECT_THAT(gone(plan_of({"Vision"}), "other"), SizeIs(2));
  EXPECT_THAT(gone(plan_of({cam + " @ latest:2", example_entity().at(second(0)).to_string()})),
              ElementsAre(0, 2, 3));
}

TEST_F(PlanForgetting, RefusesWhatNamesNothing) {
  seal_numbers("cam", 0, 2);
  EXPECT_FAILS(plan_of({"Hearing"}), StatusCode::kNotFound, "'Hearing' names no snapshot");
  EXPECT_FAILS(plan_of({""}), StatusCode::kNotFound, "names no snapshot");
  EXPECT_FAILS(plan_of({example_entity().at(second(9)).to_string()}), StatusCode::kNotFound,
               "names no snapshot");
  EXPECT_FAILS(plan_of({"Vision @ sometimes"}), StatusCode::kInvalidArgument, "sometimes");
  EXPECT_FAILS(plan_of({example_entity().to_string() + " @ +1s"}), StatusCode::kNotFound,
               "names no snapshot");
}

TEST_F(PlanForgetting, WhatIsChosenIsKeptByProtectedEntitiesAndLinksOnly) {
  seal_numbers("cam", 0, 3);
  append({linking("grasp", 9, example_entity().at(second(1)))});
  EXPECT_THAT(gone(plan_of({"Vision/RGB/head/cam"}, {.linked = true})), ElementsAre(0, 2));
  const auto made =
      plan_of({"Vision"}, {.entities = {*EntityPattern::parse("Vision/RGB/head/grasp")}});
  EXPECT_THAT(gone(made, "grasp"), IsEmpty());
  EXPECT_EQ(made->entities.at(example_entity("grasp")).shielded, 1u);
  EXPECT_THAT(gone(made), SizeIs(3));
}

TEST_F(PlanForgetting, ALatentNeedsItsModelOnlyWhereItsValueIsAskedFor) {
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = 0; i < 4; ++i)
      ASSERT_OK(writer->append({packed_example(i, example_entity())}, nullptr));
    ASSERT_OK(writer->seal());
  }
  const auto model = *temporary_file(store_, ".model");
  overwrite_file(model, as_bytes("weights"));
  ASSERT_OK(publish_model(store_, example_entity(), 1, model, example_latents(0, 4, 1)));
  ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  now_ = example_time(1000);
  const auto made = plan(all_old());
  ASSERT_OK(made);
  EXPECT_EQ(made->snapshots(), 3u);
  ForgetOptions options;
  options.rules.resize(1);
  options.rules[0].importance = ImportancePolicy::Options{"", 0.6};
  EXPECT_EQ(plan(options)->snapshots(), 3u) << "the examples have confidence 0.5";
  options.rules[0].importance->path = "x";
  EXPECT_FAILS(plan(options), StatusCode::kFailedPrecondition, "without learning");
}

TEST_F(PlanForgetting, CanBeStopped) {
  seal_numbers("cam", 0, 2);
  Recall recall(*StoreReader::open(store_), {});
  ForgetSource source(recall, accesses_);
  ForgetContext world = context();
  std::stop_source stop;
  stop.request_stop();
  world.stop = stop.get_token();
  EXPECT_FAILS(plan_forgetting(source, all_old(), world), StatusCode::kCancelled, "stopped");
}

TEST_F(PlanForgetting, AnEmptyStoreHasAnEmptyPlan) {
  ForgetOptions options = all_old();
  options.protection.linked = true;
  const auto made = plan(options);
  ASSERT_OK(made);
  EXPECT_EQ(made->snapshots(), 0u);
}

}  // namespace
}  // namespace engram::ltm
