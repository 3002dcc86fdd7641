// SPDX-License-Identifier: Apache-2.0
#include "training/augment/augment_store.h"

#include "ltm/idf/type_xml.h"
#include "ltm/recall/recall.h"
#include "ltm/recording/recorder.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_check.h"
#include "tests/augmentation/example_scene.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::training {
namespace {

using ltm::MemoryId;
using ltm::Source;

constexpr int kSnapshots = 12;

MemoryId id_of(const char* text) {
  return *MemoryId::parse(text);
}

Time time_of(int index) {
  return time_from_ns(1'645'189'616'000'000'000 + index * int64_t{200'000'000});
}

class AugmentStore : public testing::Test {
 protected:
  void SetUp() override {
    auto recorder = ltm::Recorder::open(real_, {});
    ASSERT_OK(recorder);
    for (int i = 0; i < kSnapshots; ++i) {
      const ltm::InstanceMetadata metadata{time_of(i), time_of(i), time_of(i), "camera", 0.5f};
      ltm::Commit commit{{{camera_, time_of(i), {{augmentation::example_value(), metadata}}},
                          {joints_, time_of(i), {{idf::Dict{{"x", 1.0 * i}}, metadata}}}}};
      // Only some moments were segmented.
      if (i % 2 == 0)
        commit.updates.push_back(
            {objects_,
             time_of(i),
             {{idf::Dict{{"labels", augmentation::example_labels(32, 48)}}, metadata}}});
      ASSERT_OK(recorder->commit(commit));
    }
    ASSERT_OK(recorder->close());
  }

  static AugmentOptions options_of(const char* query) {
    AugmentOptions options;
    options.query = *ltm::Query::parse(query);
    return options;
  }

  Result<AugmentReport> augment(const AugmentOptions& options, const char* to = "changed") {
    return augment_store(real_, scratch_ / to, options, {}, {});
  }

  ltm::QueryResult query(const char* text, const char* store = "changed") {
    ltm::Recall recall(*ltm::StoreReader::open(scratch_ / store), {});
    auto answer = recall.query(*ltm::Query::parse(text));
    EXPECT_OK(answer);
    return *std::move(answer);
  }

  ScratchDirectory scratch_;
  const std::filesystem::path real_ = scratch_ / "real";
  const MemoryId camera_ = id_of("Vision/RGB/head/cam");
  const MemoryId objects_ = id_of("Vision/Segmentation/head/objects");
  const MemoryId joints_ = id_of("Robot/State/arm/joints");
};

TEST_F(AugmentStore, ChangesWhatMeetsConditions) {
  auto recorder = ltm::Recorder::open(real_, {});
  ASSERT_OK(recorder);
  const MemoryId note = id_of("Notes/Text/robot/note");
  ASSERT_OK(recorder->declare(id_of("Notes/Text"), idf::Type::dict(idf::Type::memory_link())));
  for (int i = 0; i < 3; ++i)
    ASSERT_OK(recorder->commit(
        {{{note, time_of(i), {{idf::Dict{{"of", camera_.at(time_of(i)).to_string()}}, {}}}}}}));
  ASSERT_OK(recorder->close());
  const auto noted = augment(options_of("Vision/RGB @ all links-from Notes/Text/robot/note"));
  ASSERT_OK(noted);
  EXPECT_EQ(noted->entities.at(0).snapshots, 3);
  const auto others =
      augment(options_of("Vision/RGB @ all not links-from Notes/Text/robot/note"), "rest");
  ASSERT_OK(others);
  EXPECT_EQ(others->entities.at(0).snapshots, kSnapshots - 3);
  EXPECT_FAILS(augment(options_of("Vision/RGB @ all while Skill/Event/robot/pick"), "none"),
               StatusCode::kNotFound, "Skill/Event/robot/pick");
}

TEST_F(AugmentStore, MakesSnapshotsThatNameTheirOriginAndRecipe) {
  AugmentOptions options = options_of("Vision/RGB @ all");
  options.copies = 2;
  const auto report = augment(options);
  ASSERT_OK(report);
  ASSERT_EQ(report->entities.size(), 1u);
  EXPECT_EQ(report->entities[0].snapshots, kSnapshots);
  EXPECT_EQ(report->entities[0].instances, 2 * kSnapshots);
  const ltm::QueryResult answer = query("Vision @ all");
  const ltm::EntityResult* camera = answer.find_entity(camera_);
  ASSERT_NE(camera, nullptr);
  ASSERT_EQ(camera->snapshots.size(), kSnapshots);
  for (int i = 0; i < kSnapshots; ++i) {
    const ltm::SnapshotResult& snapshot = camera->snapshots[static_cast<size_t>(i)];
    EXPECT_EQ(snapshot.source, Source::kAugmented);
    EXPECT_EQ(snapshot.time, time_of(i));
    ASSERT_EQ(snapshot.instances.size(), 2u);
    EXPECT_NE(snapshot.instances[0].data, snapshot.instances[1].data);
    for (int copy = 0; copy < 2; ++copy) {
      const ltm::InstanceResult& instance = snapshot.instances[static_cast<size_t>(copy)];
      EXPECT_EQ(instance.metadata.origin, camera_.at(time_of(i)).instance(0));
      EXPECT_EQ(instance.metadata.provider, "augmentation");
      EXPECT_EQ(instance.metadata.confidence, 0.5f);
      // The recipe alone makes the same bytes again.
      const auto recipe = augmentation::Recipe::parse(instance.metadata.recipe);
      ASSERT_OK(recipe);
      EXPECT_EQ(*recipe, recipe_at(options, time_of(i), copy));
      EXPECT_EQ(*augmentation::augmented(augmentation::example_value(), nullptr, *recipe, {}),
                instance.data);
    }
  }
}

TEST_F(AugmentStore, MakesTheSameAgainAndAnotherWithAnotherSeed) {
  const auto values = [&](uint64_t seed, const char* to) {
    AugmentOptions options = options_of("Vision/RGB @ all");
    options.seed = seed;
    EXPECT_OK(augment(options, to));
    return query("@ all", to);
  };
  const ltm::QueryResult first = values(1, "first");
  EXPECT_EQ(first, values(1, "again"));
  EXPECT_FALSE(first == values(2, "other"));
}

TEST_F(AugmentStore, HoldsARecipeButForItsNoise) {
  AugmentOptions options;
  options.changes = {*augmentation::parse_change_choice("noise", 50)};
  options.hold = std::chrono::seconds(100);
  const augmentation::Recipe one = recipe_at(options, time_of(0), 0);
  const augmentation::Recipe next = recipe_at(options, time_of(1), 0);
  EXPECT_NE(one, next);
  EXPECT_EQ(augmentation::with_seed(one, 0), augmentation::with_seed(next, 0));
  EXPECT_NE(augmentation::with_seed(one, 0),
            augmentation::with_seed(recipe_at(options, time_of(0), 1), 0));
  options.hold = Duration::zero();
  EXPECT_NE(augmentation::with_seed(recipe_at(options, time_of(0), 0), 0),
            augmentation::with_seed(recipe_at(options, time_of(1), 0), 0));
  // Times before 1970 are moments, too.
  options.hold = std::chrono::seconds(1);
  EXPECT_NE(augmentation::with_seed(recipe_at(options, time_from_ns(-1), 0), 0),
            augmentation::with_seed(recipe_at(options, time_from_ns(1), 0), 0));
}

TEST_F(AugmentStore, TellsTheSourceWhereOnlyIdsAreAsked) {
  ASSERT_OK(augment(options_of("Vision/RGB @ all")));
  const ltm::QueryResult answer = query("?ids Vision @ all");
  EXPECT_EQ(answer.find_snapshot(camera_.at(time_of(0)))->source, Source::kAugmented);
  const ltm::QueryResult real = query("?ids Vision @ all", "real");
  EXPECT_EQ(real.find_snapshot(camera_.at(time_of(0)))->source, Source::kRecorded);
}

TEST_F(AugmentStore, NeverReplacesWhatWasRecorded) {
  ASSERT_OK(augment(options_of("Vision/RGB @ all")));
  ltm::QueryResult both = query("Vision/RGB @ all");
  ASSERT_OK(both.merge(query("Vision/RGB @ all", "real")));
  for (int i = 0; i < kSnapshots; ++i) {
    const ltm::SnapshotResult* one = both.find_snapshot(camera_.at(time_of(i)));
    EXPECT_EQ(one->source, Source::kRecorded);
    EXPECT_EQ(one->instances.front().data, augmentation::example_value());
  }
}

TEST_F(AugmentStore, KeepsItsMarkThroughWhateverBecomesOfTheStore) {
  ASSERT_OK(augment(options_of("Vision/RGB @ all")));
  const ltm::QueryResult before = query("@ all");
  ASSERT_OK(ltm::compact(scratch_ / "changed", {}, {}, {}));
  EXPECT_EQ(query("@ all"), before);
  const auto summary = (*ltm::StoreReader::open(scratch_ / "changed"))->summary(camera_);
  EXPECT_EQ(summary->augmented_snapshots, kSnapshots);
  EXPECT_EQ((*ltm::StoreReader::open(real_))->summary(camera_)->augmented_snapshots, 0u);
  const auto checked = ltm::check_store(scratch_ / "changed", {}, {}, {});
  ASSERT_OK(checked);
  EXPECT_TRUE(checked->findings.empty());
}

TEST_F(AugmentStore, LeavesOutWhatHasNoImagesAndWhatWasChangedAlready) {
  const auto report = augment(options_of("@ all"));
  ASSERT_OK(report);
  ASSERT_EQ(report->entities.size(), 3u);
  EXPECT_EQ(report->entities[0].entity, joints_);
  EXPECT_EQ(report->entities[0].skipped_reason, "no recorded snapshot with images");
  const auto again = augment_store(scratch_ / "changed", scratch_ / "twice",
                                   options_of("Vision/RGB @ all"), {}, {});
  ASSERT_OK(again);
  EXPECT_EQ(again->entities[0].snapshots, 0u);
  EXPECT_EQ(again->entities[0].left_out, kSnapshots);
}

TEST_F(AugmentStore, ChangesObjectsWhereAnotherEntityTellsThem) {
  AugmentOptions options = options_of("Vision @ all");
  options.mask_entity = objects_;
  options.label = 3;
  options.changes = {*augmentation::parse_change_choice("recolour", 100)};
  const auto report = augment(options);
  ASSERT_OK(report);
  EXPECT_EQ(report->entities[0].snapshots, kSnapshots / 2);
  EXPECT_EQ(report->entities[0].without_mask, kSnapshots / 2);
  EXPECT_EQ(report->entities[1].skipped_reason, "its images are the mask");
  const ltm::QueryResult answer = query("Vision/RGB @ latest");
  const idf::Data& changed = answer.find_entity(camera_)->snapshots.front().instances.front().data;
  const idf::NdArray image = augmentation::example_image(32, 48);
  const idf::NdArray objects = augmentation::example_labels(32, 48);
  const auto before = image.values<uint8_t>();
  const auto after = changed.at("image")->get<idf::NdArray>().values<uint8_t>();
  const auto labels = objects.values<uint8_t>();
  bool is_object_changed = false;
  for (size_t i = 0; i < before.size(); ++i) {
    if (labels[i / 3] == 0) {
      EXPECT_EQ(after[i], before[i]);
    }
    is_object_changed = is_object_changed || after[i] != before[i];
  }
  EXPECT_TRUE(is_object_changed);
}

TEST_F(AugmentStore, RefusesWhatCannotBe) {
  EXPECT_FAILS(augment(options_of("Audio @ all")), StatusCode::kNotFound, "none of its 3 entities");
  AugmentOptions options = options_of("Vision/RGB @ all");
  options.copies = 0;
  EXPECT_FAILS(augment(options), StatusCode::kInvalidArgument, "copies: found 0, needs 1 to 64");
  options = options_of("Vision/RGB @ all");
  options.changes = {*augmentation::parse_change_choice("replace", 50)};
  EXPECT_FAILS(augment(options), StatusCode::kInvalidArgument, "where the object is");
  options.mask_entity = id_of("Vision/Segmentation/head/nothing");
  EXPECT_FAILS(augment(options), StatusCode::kNotFound, "nothing");
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "changed"));
  ASSERT_OK(augment(options_of("Vision/RGB @ all")));
  EXPECT_FAILS(augment(options_of("Vision/RGB @ all")), StatusCode::kAlreadyExists, "a new place");
}

}  // namespace
}  // namespace engram::training
