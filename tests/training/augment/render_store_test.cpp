// SPDX-License-Identifier: Apache-2.0
#include "training/augment/render_store.h"

#include <gmock/gmock.h>

#include <set>

#include "ltm/recall/recall.h"
#include "ltm/recording/recorder.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::training {
namespace {

using augmentation::Recipe;
using augmentation::SceneChangeKind;
using datasets::RememberedScene;
using ltm::MemoryId;

constexpr int kWidth = 32;
constexpr int kHeight = 24;
constexpr int kSnapshots = 10;

augmentation::PartPose at(double x, double y, double z) {
  return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1};
}

Time time_of(int index) {
  return time_from_ns(1'645'189'616'000'000'000 + index * int64_t{500'000'000});
}

idf::NdArray grey_image(uint8_t level) {
  return idf::NdArray::take<uint8_t>({kHeight, kWidth, 3},
                                     std::vector<uint8_t>(3 * kWidth * kHeight, level));
}

/// Two boxes before a camera; nobody remembers them at odd moments.
class TwoBoxes final : public datasets::SceneSource {
 public:
  [[nodiscard]] std::string name() const override { return "two boxes"; }

  Result<std::optional<RememberedScene>> scene(ltm::StoreReader& /*store*/,
                                               const ltm::Snapshot& snapshot,
                                               size_t index) override {
    const auto moment = (snapshot.time - time_of(0)) / (time_of(1) - time_of(0));
    if (moment % 2 == 1) return std::optional<RememberedScene>();
    RememberedScene remembered;
    remembered.scene.camera = {kWidth,
                               kHeight,
                               30,
                               30,
                               (kWidth - 1) / 2.0,
                               (kHeight - 1) / 2.0,
                               at(0.1 * static_cast<double>(index), 0, 0)};
    for (const auto& [name, x] : {std::pair{"left", -0.4}, {"right", 0.4}})
      remembered.scene.shapes.push_back(
          {name, augmentation::ShapeKind::kBox, {0.2, 0.2, 0.2}, at(x, 0, 2)});
    remembered.scene.lamps.push_back({augmentation::LampKind::kPoint, at(0, -1, 0)});
    remembered.things_in_sight = {"left", "right"};
    return std::optional(remembered);
  }

  [[nodiscard]] Result<idf::Data> seen(const idf::Data& recorded,
                                       const augmentation::SceneCamera& camera,
                                       const idf::NdArray& image) const override {
    idf::Dict value = recorded.get<idf::Dict>();
    value.set("image", image);
    value.set("x", camera.pose[3]);
    return idf::Data(value);
  }
};

class RenderStore : public testing::Test {
 protected:
  void SetUp() override {
    auto recorder = ltm::Recorder::open(real_, {});
    ASSERT_OK(recorder);
    for (int i = 0; i < kSnapshots; ++i) {
      const ltm::InstanceMetadata metadata{time_of(i), time_of(i), time_of(i), "camera", 0.5f};
      std::vector<ltm::Instance> eyes;
      for (int eye = 0; eye < 2; ++eye)
        eyes.push_back({idf::Dict{{"image", grey_image(100)}, {"eye", eye}}, metadata});
      ASSERT_OK(recorder->commit({{{camera_, time_of(i), eyes}}}));
    }
    ASSERT_OK(recorder->close());
    options_.query = *ltm::Query::parse("@ all");
    options_.blender.samples = 2;
    options_.width = 16;
  }

  Result<AugmentReport> render(const char* to = "rendered") {
    return render_store(real_, scratch_ / to, options_, boxes_, {}, {});
  }

  ltm::QueryResult everything(const char* store = "rendered") {
    ltm::Recall recall(*ltm::StoreReader::open(scratch_ / store), {});
    auto answer = recall.query(*ltm::Query::parse("@ all"));
    EXPECT_OK(answer);
    return *std::move(answer);
  }

  ScratchDirectory scratch_;
  const std::filesystem::path real_ = scratch_ / "real";
  const MemoryId camera_ = *MemoryId::parse("Vision/RGB/head/stereo");
  RenderOptions options_;
  TwoBoxes boxes_;
};

TEST_F(RenderStore, MakesEachKindOfEachEyeAndNamesOriginAndRecipe) {
  options_.every = std::chrono::seconds(2);
  options_.hold = std::chrono::seconds(1);
  const auto report = render();
  if (report.status().code() == StatusCode::kNotFound) GTEST_SKIP() << report.status().to_string();
  ASSERT_OK(report);
  ASSERT_EQ(report->entities.size(), 1u);
  // Moments 0, 1, 4, 5, 8 and 9 of 0 to 9, and nobody remembers the odd ones.
  EXPECT_EQ(report->entities[0].snapshots, 3u);
  EXPECT_EQ(report->entities[0].without_scene, 3u);
  EXPECT_EQ(report->entities[0].instances, 3u * 5 * 2);
  const ltm::QueryResult answer = everything();
  const ltm::EntityResult* camera = answer.find_entity(camera_);
  ASSERT_NE(camera, nullptr);
  ASSERT_EQ(camera->snapshots.size(), 3u);
  for (const ltm::SnapshotResult& snapshot : camera->snapshots) {
    EXPECT_EQ(snapshot.source, ltm::Source::kAugmented);
    ASSERT_EQ(snapshot.instances.size(), 10u);
    for (size_t i = 0; i < 10; ++i) {
      const ltm::InstanceResult& instance = snapshot.instances[i];
      EXPECT_EQ(instance.metadata.origin,
                camera_.at(snapshot.time).instance(static_cast<int32_t>(i % 2)));
      const auto recipe = Recipe::parse(instance.metadata.recipe);
      ASSERT_OK(recipe);
      ASSERT_EQ(recipe->changes.size(), 2u);
      EXPECT_EQ(recipe->changes[0].name,
                std::string("scene_") +
                    augmentation::to_string(augmentation::all_scene_changes()[i / 2]));
      EXPECT_EQ(recipe->changes[1].name, "render");
      EXPECT_EQ(*recipe->changes[1].integer("width"), 16);
      // As large as what was recorded, and what else was there still is.
      EXPECT_EQ(instance.data.at("image")->get<idf::NdArray>().shape(), grey_image(0).shape());
      EXPECT_EQ(instance.data.at("eye")->as_number(), static_cast<double>(i % 2));
    }
    // Another view is elsewhere, the other changes are not.
    EXPECT_EQ(snapshot.instances[0].data.at("x")->as_number(), 0);
    EXPECT_NE(snapshot.instances[6].data.at("x")->as_number(), 0);
    EXPECT_FALSE(snapshot.instances[0].data.at("image")->get<idf::NdArray>() ==
                 snapshot.instances[2].data.at("image")->get<idf::NdArray>());
  }
}

TEST_F(RenderStore, MakesTheSameAgain) {
  options_.kinds = {SceneChangeKind::kRecolour, SceneChangeKind::kLight};
  options_.hold = Duration::zero();
  options_.every = std::chrono::seconds(3);
  const auto first = render("first");
  if (first.status().code() == StatusCode::kNotFound) GTEST_SKIP() << first.status().to_string();
  ASSERT_OK(first);
  ASSERT_OK(render("again"));
  EXPECT_EQ(first->entities[0].snapshots, 3u);
  EXPECT_EQ(everything("first"), everything("again"));
}

TEST_F(RenderStore, CountsWhatNobodyRemembers) {
  options_.kinds = {SceneChangeKind::kOriginal};
  options_.query = *ltm::Query::parse("@ latest");
  const auto report = render();
  if (report.status().code() == StatusCode::kNotFound) GTEST_SKIP() << report.status().to_string();
  ASSERT_OK(report);
  EXPECT_EQ(report->entities[0].without_scene, 1u);
  EXPECT_EQ(report->entities[0].skipped_reason, "what was there at these moments is not known");
}

TEST_F(RenderStore, SaysThatBlenderIsMissingBeforeAnythingIsWritten) {
  options_.blender.program = "no-such-blender";
  EXPECT_FAILS(render(), StatusCode::kNotFound, "apt install blender");
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "rendered"));
}

TEST_F(RenderStore, HoldsARecipeForAWhile) {
  const RememberedScene scene =
      **boxes_.scene(*ltm::StoreReader::open(real_).value(), {camera_, time_of(0), {}}, 0);
  options_.hold = std::chrono::seconds(1);
  std::set<std::string> recipes;
  for (int i = 0; i < kSnapshots; ++i)
    recipes.insert(
        *scene_recipe_at(options_, SceneChangeKind::kView, scene, time_of(i), 0)->to_text());
  EXPECT_EQ(recipes.size(), 5u);
  EXPECT_FALSE(*scene_recipe_at(options_, SceneChangeKind::kView, scene, time_of(0), 0) ==
               *scene_recipe_at(options_, SceneChangeKind::kView, scene, time_of(0), 1));
}

TEST_F(RenderStore, ChecksItsOptions) {
  const auto refuses = [](auto change, const char* what) {
    RenderOptions options;
    options.query = *ltm::Query::parse("@ all");
    change(options);
    EXPECT_THAT(options.validate().to_string(), ::testing::HasSubstr(what));
  };
  refuses([](RenderOptions& o) { o.kinds.clear(); }, "found no change");
  refuses([](RenderOptions& o) { o.width = 15; }, "width of 15");
  refuses([](RenderOptions& o) { o.every = Duration(-1); }, "needs 0 or more");
  refuses([](RenderOptions& o) { o.copies = 0; }, "copies: found 0");
}

}  // namespace
}  // namespace engram::training
