// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "datasets/kitchen/kitchen_types.h"
#include "ltm/idf/json.h"
#include "ltm/memory/links.h"
#include "ltm/recording/recorder.h"
#include "server/skills/skill_description.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

using ::skill::Outcome;

KitchenOptions tiny(uint64_t seed, double seconds) {
  KitchenOptions options = KitchenOptions::fast();
  options.seed = seed;
  options.seconds = seconds;
  options.width = options.height = 32;
  return options;
}

std::vector<ltm::Commit> recorded(const KitchenOptions& options) {
  std::vector<ltm::Commit> commits;
  const auto summary = simulate_kitchen(options,
                                        [&](const ltm::Commit& commit) {
                                          commits.push_back(commit);
                                          return Status();
                                        },
                                        {});
  EXPECT_OK(summary);
  return commits;
}

TEST(Kitchen, GivesEqualCommitsForEqualSeeds) {
  KitchenOptions options = KitchenOptions::fast();
  options.seconds = 4;
  options.records_depth = true;
  const std::vector<ltm::Commit> first = recorded(options);
  EXPECT_TRUE(first == recorded(options));
  ++options.seed;
  EXPECT_FALSE(first == recorded(options));
}

TEST(Kitchen, RecordsAtTheRatesThatItPromises) {
  const std::vector<ltm::Commit> commits = recorded(tiny(5, 3));
  EXPECT_EQ(commits.size(), 300u);
  std::map<std::string, int> snapshots;
  for (const ltm::Commit& commit : commits) {
    EXPECT_OK(commit.check());
    for (const ltm::EntityUpdate& update : commit.updates) {
      ++snapshots[update.entity.to_string()];
      EXPECT_EQ(update.instances.size(), update.entity.names()[1] == "RGB" ? 2u : 1u);
    }
  }
  EXPECT_EQ(snapshots["RobotState/Proprioception/robot/joints"], 300);
  EXPECT_EQ(snapshots["RobotState/Localization/robot/platform"], 300);
  EXPECT_EQ(snapshots["Vision/RGB/head/stereo"], 60);
  int objects = 0;
  for (const auto& [name, count] : snapshots)
    if (name.starts_with("Objects/Instances/")) {
      ++objects;
      EXPECT_GE(count, 15) << name;
    }
  EXPECT_GE(objects, 7);
}

TEST(Kitchen, MakesAboutAsManyBytesAsARobotDoes) {
  KitchenOptions options;
  options.seconds = 1;
  options.is_fine = false;
  const auto summary = simulate_kitchen(options, [](const ltm::Commit&) { return Status(); }, {});
  ASSERT_OK(summary);
  EXPECT_NEAR(static_cast<double>(summary->raw_bytes), 35.665e6, 0.2 * 35.665e6);
}

/// A recording with a failed grasp and an action that is stopped, in a store too.
class KitchenEpisode : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchDirectory();
    auto recorder = ltm::Recorder::open(scratch_->path() / "kitchen.engram", {});
    ASSERT_OK(recorder);
    for (const auto& [segment, type] : kitchen_types()) ASSERT_OK(recorder->declare(segment, type));
    const auto summary = simulate_kitchen(
        tiny(1, 38),
        [&](const ltm::Commit& commit) {
          for (const ltm::EntityUpdate& update : commit.updates)
            for (size_t i = 0; i < update.instances.size(); ++i)
              values_[update.id().instance(static_cast<int32_t>(i))] = update.instances[i].data;
          return recorder->commit(commit);
        },
        {});
    ASSERT_OK(summary);
    summary_ = *summary;
    for (const auto& [entity, counters] : recorder->counters()) {
      EXPECT_EQ(counters.reinterpreted, 0u) << entity.to_string();
      EXPECT_EQ(counters.kept, counters.offered) << entity.to_string();
    }
    ASSERT_OK(recorder->close());
  }
  static void TearDownTestSuite() {
    delete scratch_;
    values_.clear();
  }

  template <typename T>
  static T value(const ltm::MemoryId& id) {
    const auto found = values_.find(id);
    EXPECT_TRUE(found != values_.end()) << id.to_string();
    return found == values_.end() ? T() : T::from_idf(found->second).value();
  }

  static std::vector<::kitchen::Action> ended_actions() {
    std::vector<::kitchen::Action> actions;
    for (const auto& [id, data] : values_)
      if (id.names()[0] == "Skill" && id.names()[1] == "Event") {
        actions.push_back(::kitchen::Action::from_idf(data).value());
        if (actions.back().outcome == Outcome::RUNNING) actions.pop_back();
      }
    return actions;
  }

  static inline ScratchDirectory* scratch_ = nullptr;
  static inline KitchenSummary summary_;
  static inline std::map<ltm::MemoryId, idf::Data> values_;
};

TEST_F(KitchenEpisode, HasActionsThatSucceedFailAndAreStopped) {
  EXPECT_GE(summary_.succeeded, 8);
  EXPECT_GE(summary_.failed, 1);
  EXPECT_GE(summary_.stopped, 1);
  std::map<Outcome, int> outcomes;
  for (const auto& action : ended_actions()) ++outcomes[action.outcome];
  EXPECT_EQ(outcomes[Outcome::SUCCESS], summary_.succeeded);
  EXPECT_EQ(outcomes[Outcome::FAILURE], summary_.failed);
  EXPECT_EQ(outcomes[Outcome::STOP], summary_.stopped);
}

TEST_F(KitchenEpisode, OutcomesAreWhatThePhysicsDid) {
  int picks = 0;
  int places = 0;
  for (const ::kitchen::Action& action : ended_actions()) {
    ASSERT_TRUE(action.ended && action.object_before && action.object_after);
    EXPECT_GT(*action.ended, action.started);
    const auto before = value<::kitchen::ObjectInstance>(*action.object_before);
    const auto after = value<::kitchen::ObjectInstance>(*action.object_after);
    const auto moved = after.pose_world_object.position - before.pose_world_object.position;
    const bool succeeded = action.outcome == Outcome::SUCCESS;
    if (action.skill == "robot/pick") {
      EXPECT_EQ(succeeded, moved.z() > 0.08) << action.reason;
      EXPECT_EQ(succeeded, after.held_by == action.hand) << action.reason;
      EXPECT_TRUE(before.held_by.empty());
      ++picks;
    } else if (action.skill == "robot/place") {
      const auto surface = value<::kitchen::Surface>(
          action.surface->at(time_from_ns(to_ns(KitchenOptions().start))).instance(0));
      const auto on =
          surface.pose_world_surface.isometry().inverse() * after.pose_world_object.position;
      const bool stands = std::abs(on.x()) < 0.5 * surface.depth &&
                          std::abs(on.y()) < 0.5 * surface.width && on.z() > 0 && on.z() < 0.2;
      EXPECT_EQ(succeeded, stands) << action.reason;
      EXPECT_TRUE(after.held_by.empty());
      EXPECT_EQ(before.held_by, action.hand);
      ++places;
    }
    if (action.outcome == Outcome::STOP) {
      ASSERT_EQ(action.stopped_by.size(), 1U);
      EXPECT_EQ(value<::kitchen::Speech>(action.stopped_by[0]).text, "Stop!");
    }
  }
  EXPECT_GE(picks, 3);
  EXPECT_GE(places, 2);
}

TEST_F(KitchenEpisode, EachExecutionLeadsToWhatWasSaid) {
  for (const ::kitchen::Action& action : ended_actions()) {
    const auto request = value<::skill::ExecutionRequest>(action.request);
    EXPECT_EQ(request.skill, action.skill);
    ASSERT_EQ(request.causes.size(), 1U);
    const auto plan = value<::kitchen::Plan>(request.causes[0]);
    EXPECT_FALSE(value<::kitchen::Speech>(plan.command).text.empty());
    // The first of the two snapshots.
    ASSERT_TRUE(action.execution);
    const auto begun = value<::kitchen::Action>(*action.execution);
    EXPECT_EQ(begun.stage, ::skill::Stage::STARTED);
    EXPECT_EQ(begun.started, action.started);

    // The memory of skills would take what was asked for.
    const auto described =
        skills::SkillDescription::parse(value<::skill::Executable>(action.executable).description);
    ASSERT_OK(described);
    EXPECT_EQ("robot/" + described->name, action.skill);
    const auto given = idf::from_json_text(action.parameters);
    ASSERT_OK(given);
    EXPECT_OK(described->parameters.fit(*given));
  }
}

TEST_F(KitchenEpisode, LinksLeadToWhatWasRecorded) {
  size_t checked = 0;
  for (const auto& [id, data] : values_)
    for (const ltm::Link& link : ltm::find_links(data)) {
      EXPECT_TRUE(values_.contains(link.id)) << id.to_string() << " -> " << link.id.to_string();
      ++checked;
    }
  EXPECT_GT(checked, 4000u);
}

/// Without what a recording without images has not got.
idf::Data without_image(idf::Data data) {
  if (idf::Dict* members = data.get_if<idf::Dict>(); members != nullptr)
    for (const char* const member : {"image", "has_images"})
      if (idf::Data* value = members->find(member); value != nullptr) *value = idf::None{};
  return data;
}

TEST_F(KitchenEpisode, IsTheSameWithoutImages) {
  KitchenOptions options = tiny(1, 38);
  options.has_images = false;
  std::map<ltm::MemoryId, idf::Data> plain;
  for (const ltm::Commit& commit : recorded(options))
    for (const ltm::EntityUpdate& update : commit.updates)
      plain[update.id().instance(0)] = update.instances.at(0).data;
  size_t same = 0;
  for (const auto& [id, data] : values_) {
    if (id.names()[0] == "Vision") continue;
    const auto found = plain.find(id);
    ASSERT_TRUE(found != plain.end()) << id.to_string();
    ASSERT_TRUE(without_image(found->second) == without_image(data)) << id.to_string();
    ++same;
  }
  EXPECT_EQ(same, plain.size());
  EXPECT_GT(same, 7600U);
  // No link leads to what is not there.
  for (const auto& [id, data] : plain)
    for (const ltm::Link& link : ltm::find_links(data))
      EXPECT_TRUE(plain.contains(link.id)) << id.to_string() << " -> " << link.id.to_string();
}

TEST_F(KitchenEpisode, IsTheSameWithColoursButForThem) {
  KitchenOptions options = tiny(1, 38);
  options.has_colours = true;
  std::map<std::string, std::set<std::string>> colours;
  size_t other_pixels = 0;
  size_t same = 0;
  for (const ltm::Commit& commit : recorded(options))
    for (const ltm::EntityUpdate& update : commit.updates)
      for (size_t i = 0; i < update.instances.size(); ++i) {
        const ltm::MemoryId id = update.id().instance(static_cast<int32_t>(i));
        ASSERT_TRUE(values_.contains(id)) << id.to_string();
        const idf::Data& plain = values_.at(id);
        idf::Data data = update.instances[i].data;
        if (id.names()[0] == "Vision" && id.names()[1] == "RGB") {
          other_pixels += *data.at("image") == *plain.at("image") ? 0 : 1;
          continue;
        }
        if (id.names()[0] == "Objects" && id.names()[1] == "Instances") {
          const std::string* colour = data.at("colour")->get_if<std::string>();
          ASSERT_NE(colour, nullptr);
          colours[id.names()[3]].insert(*colour);
          data = ::kitchen::ObjectInstance::from_idf(data)->to_idf();
        }
        ASSERT_TRUE(data == plain) << id.to_string();
        ++same;
      }
  EXPECT_GT(same, 7600U);
  EXPECT_GT(other_pixels, 100U);
  std::set<std::string> words;
  for (const auto& [thing, told] : colours) {
    EXPECT_EQ(told.size(), 1U) << thing;
    words.insert(told.begin(), told.end());
    if (thing == "blue_mug_1") {
      EXPECT_EQ(*told.begin(), "blue");
    }
  }
  EXPECT_GE(words.size(), 3U);
  EXPECT_TRUE(std::ranges::includes(
      std::set<std::string>{"red", "yellow", "green", "turquoise", "blue", "purple"}, words));
}

TEST(Kitchen, TellsOfColoursInTheTypeOnlyWhereThereAreSome) {
  for (const bool has_colours : {false, true})
    for (const auto& [segment, type] : kitchen_types(false, has_colours)) {
      if (segment.to_string() != "Objects/Instances") continue;
      EXPECT_EQ(type == ::kitchen::ObjectInstance::idf_type(), !has_colours);
    }
}

TEST(Kitchen, TellsWhatIsWrongWithItsOptions) {
  KitchenOptions options = KitchenOptions::fast();
  options.width = 127;
  const CommitSink none = [](const ltm::Commit&) { return Status(); };
  EXPECT_FAILS(simulate_kitchen(options, none, {}), StatusCode::kInvalidArgument, "127 x 128");
  options = KitchenOptions::fast();
  options.has_images = false;
  options.records_depth = true;
  EXPECT_FAILS(simulate_kitchen(options, none, {}), StatusCode::kInvalidArgument,
               "depth without images");
  options = KitchenOptions::fast();
  options.seconds = 0.5;
  EXPECT_FAILS(simulate_kitchen(options, none, {}), StatusCode::kInvalidArgument, "0.5 seconds");
}

TEST(Kitchen, EndsWithTheErrorOfWhoTakesIt) {
  int count = 0;
  const CommitSink failing = [&](const ltm::Commit&) {
    return ++count == 7 ? unavailable("the disk is gone") : Status();
  };
  EXPECT_FAILS(simulate_kitchen(tiny(1, 5), failing, {}), StatusCode::kUnavailable, "disk is gone");
  EXPECT_EQ(count, 7);
}

}  // namespace
}  // namespace engram::datasets
