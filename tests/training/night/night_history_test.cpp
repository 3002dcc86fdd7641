// SPDX-License-Identifier: Apache-2.0
// What one night leaves for the next, and what the next does with it.
#include "training/night/night_history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ltm/core/file.h"
#include "ltm/store/checkpoint_file.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_reader.h"
#include "tests/training/recorded_scene.h"
#include "training/night/consolidate.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::kSquare;
using engram::testing::night;
using engram::testing::quick_consolidation;
using engram::testing::quick_options;
using engram::testing::record;
using engram::testing::ScratchPath;
using ::testing::Contains;
using ::testing::HasSubstr;

/// Networks are tried, because over so many nights their bytes are nothing, and lose, because two
/// steps teach them nothing.
ConsolidateOptions losing() {
  auto chosen = quick_consolidation();
  chosen.train = quick_options(2);
  chosen.train.width = 0;
  chosen.representation.kind = Representation::kAuto;
  chosen.representation.bound_db = 30;
  chosen.representation.video_effort = 1;
  chosen.representation.nights = 100000;
  return chosen;
}

NightHistory example() {
  NightHistory history;
  history.networks_lost_at = 40;
  history.chain = {std::chrono::milliseconds(50), 24};
  history.lines["av1:effort=5"] = {{0.25, 31, 36.5, 0.4}, {0.5, 20, 40, 0.125}};
  return history;
}

TEST(NightHistory, IsReadAsItWasWritten) {
  const ScratchPath store("history");
  record(store.path(), kSquare, 0, 2);
  EXPECT_EQ(read_history(store.path(), id(kSquare)), NightHistory{});
  write_history(store.path(), id(kSquare), example());
  EXPECT_EQ(read_history(store.path(), id(kSquare)), example());
}

TEST(NightHistory, IsEmptyWhereItsFileIsHostile) {
  const ScratchPath store("hostile_history");
  record(store.path(), kSquare, 0, 2);
  const std::string large(size_t{2} << 20, ' ');
  for (const std::string& text : std::vector<std::string>{
           large + R"({"networks_lost_at": 7, "videos": {}})", "", "{", "[]", "7",
           R"({"networks_lost_at": "many", "videos": {}})",
           R"({"networks_lost_at": 1, "videos": [[1]]})",
           R"({"networks_lost_at": 1, "videos": {"av1": [{"slope": 1}]}})",
           R"({"networks_lost_at": 1, "videos": {"av1": [[[[[[]]]]]]}})",
           R"({"networks_lost_at": 0, "videos": {}, "chain": []})",
           R"({"networks_lost_at": 0, "videos": {},
                                    "chain": {"access_ns": 50, "rows": 0}})",
           R"({"networks_lost_at": 0, "videos": {},
                                    "chain": {"access_ns": 50, "rows": 4294967312}})",
           R"({"networks_lost_at": 0, "videos": {}, "chain": {"rows": 16}})"}) {
    ASSERT_TRUE(
        replace_file(ltm::history_file(store.path(), id(kSquare)), std::as_bytes(std::span(text)))
            .ok());
    EXPECT_EQ(read_history(store.path(), id(kSquare)), NightHistory{}) << text.substr(0, 80);
  }
}

TEST(NightHistory, TrainsNetworksWhereItsCountCannotBe) {
  const ScratchPath store("made_up_history");
  record(store.path(), kSquare, 0, 30);
  write_history(store.path(), id(kSquare), {.networks_lost_at = UINT64_MAX, .lines = {}});
  EXPECT_THAT(night(store.path(), losing()).notes, Contains(HasSubstr("video alone")));
  EXPECT_EQ(read_history(store.path(), id(kSquare)).networks_lost_at, 30U);
}

TEST(NightHistory, TeachesSearchesOfTheSameCodecAlone) {
  const NightHistory history = example();
  EntityVideos same(2, {.codec = "av1", .settings = "effort=5"});
  history.teach(same);
  EXPECT_EQ(same.search_of(1).history().line(), history.lines.at("av1:effort=5")[1]);
  EntityVideos slower(2, {.codec = "av1", .settings = "effort=7"});
  history.teach(slower);
  EXPECT_EQ(slower.search_of(1).history().line(), history.lines.at("av1:effort=5")[1])
      << "what is known of another effort is nearer than nothing";
  EntityVideos hevc(2, {.codec = "h265", .settings = "effort=5"});
  EntityVideos wider(3, {.codec = "av1", .settings = "effort=5"});
  EntityVideos none(0, {.codec = "av1", .settings = "effort=5"});
  for (EntityVideos* other : {&hevc, &wider, &none}) {
    history.teach(*other);
    for (size_t i = 0; i < other->members(); ++i)
      EXPECT_TRUE(other->search_of(i).history().is_empty());
  }
  NightHistory learned;
  learned.learn(hevc);  // Nothing was searched for.
  EXPECT_EQ(learned, NightHistory{});
  learned.learn(same);
  EXPECT_EQ(learned.lines, history.lines);
}

TEST(NightHistory, CountsWhatWasForgottenToo) {
  const ScratchPath store("history_of_forgotten");
  record(store.path(), kSquare, 0, 10);
  const auto times = engram::testing::scene_source(10).times;
  const ltm::ForgetSet gone{{id(kSquare), {times[0], times[1], times[2], times[3]}}};
  ASSERT_TRUE(ltm::forget_snapshots(store.path(), gone).ok());
  auto reader = ltm::StoreReader::open(store.path());
  ASSERT_TRUE(reader.ok()) << reader.status().to_string();
  EXPECT_EQ(*snapshots_ever(**reader, id(kSquare)), 10U);
}

TEST(NightHistory, SparesNetworksThatLost) {
  const ScratchPath store("networks_lost");
  record(store.path(), kSquare, 0, 30);
  const EntityReport first = night(store.path(), losing());
  EXPECT_THAT(first.notes, Contains(HasSubstr("video alone")));
  EXPECT_EQ(read_history(store.path(), id(kSquare)).networks_lost_at, 30U);

  record(store.path(), kSquare, 30, 20);
  const EntityReport second = night(store.path(), losing());
  EXPECT_THAT(second.notes, Contains(HasSubstr("lost against video alone at 30 snapshots")));
  EXPECT_EQ(second.forms.latent_rows + second.forms.residual_rows, 0);
  EXPECT_EQ(read_history(store.path(), id(kSquare)).networks_lost_at, 30U);

  record(store.path(), kSquare, 50, 10);
  const EntityReport third = night(store.path(), losing());
  EXPECT_THAT(third.notes, ::testing::Not(Contains(HasSubstr("at 30 snapshots"))));
  EXPECT_EQ(read_history(store.path(), id(kSquare)).networks_lost_at, 60U) << "tried again";

  record(store.path(), kSquare, 60, 4);
  auto anew = losing();
  anew.starts_anew = true;
  night(store.path(), anew);
  EXPECT_EQ(read_history(store.path(), id(kSquare)).networks_lost_at, 64U) << "as it was told";
}

}  // namespace
}  // namespace engram::training
