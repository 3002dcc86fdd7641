// SPDX-License-Identifier: Apache-2.0
// The commands `ls` and `export` as users meet them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "ltm/recording/recorder.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

class ListAndExport : public ::testing::Test {
 protected:
  void SetUp() override {
    auto recorder = ltm::Recorder::open(store_, {});
    ASSERT_OK(recorder);
    for (int64_t i = 0; i < 60; ++i)
      ASSERT_OK(recorder->commit({{ltm::example_snapshot(ltm::example_entity(), i),
                                   ltm::example_snapshot(ltm::example_entity("other"), i)}}));
    ASSERT_OK(recorder->close());
  }

  [[nodiscard]] RunResult ls(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"ls", store_};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run_engram(all);
  }

  ScratchDirectory directory_;
  std::string store_ = (directory_ / "store").string();
  std::string out_ = (directory_ / "out").string();
};

TEST_F(ListAndExport, ListsLevelByLevel) {
  EXPECT_THAT(ls({}).out, HasSubstr("Vision         2        120"));
  EXPECT_THAT(ls({"Vision/RGB"}).out, HasSubstr("Vision/RGB/head"));
  const Json json = Json::parse(ls({"Vision/RGB/head", "--json"}).out);
  ASSERT_EQ(json["entries"].size(), 2u);
  EXPECT_EQ(json["entries"][0]["id"], "Vision/RGB/head/cam");
  EXPECT_EQ(json["entries"][0]["snapshots"], 60);
  EXPECT_GT(json["entries"][0]["sealed_bytes"], 0);
}

TEST_F(ListAndExport, ListsSnapshotsThatMeetConditions) {
  auto recorder = ltm::Recorder::open(store_, {});
  ASSERT_OK(recorder);
  const ltm::MemoryId linked = ltm::example_entity().at(ltm::example_time(3));
  ASSERT_OK(recorder->declare(*ltm::MemoryId::parse("Notes/Text"),
                              idf::Type::dict(idf::Type::memory_link())));
  ASSERT_OK(recorder->commit({{{*ltm::MemoryId::parse("Notes/Text/robot/note"),
                                *linked.time(),
                                {{idf::Dict{{"of", linked.to_string()}}, {}}}}}}));
  ASSERT_OK(recorder->close());
  const RunResult found =
      ls({"Vision/RGB/head/cam @ all links-from Notes/Text/robot/note", "--json"});
  const Json json = Json::parse(found.out);
  ASSERT_EQ(json["entities"].size(), 1u) << found.err;
  ASSERT_EQ(json["entities"][0]["snapshots"].size(), 1u);
  EXPECT_EQ(json["entities"][0]["snapshots"][0]["time_ns"], to_ns(ltm::example_time(3)));
}

TEST_F(ListAndExport, ListsSnapshotsUpToALimitAndSaysHowManyMore) {
  EXPECT_THAT(ls({"Vision/RGB/head/cam"}).out, HasSubstr("and 10 more"));
  const RunResult all = ls({"Vision/RGB/head/cam", "--limit", "60"});
  EXPECT_THAT(all.out, Not(HasSubstr("more")));
  EXPECT_THAT(ls({".*/.*/.*/cam @ 2..3"}).out, HasSubstr("2020-09-13 12:26:40.600000"));
  EXPECT_THAT(ls({ltm::example_entity().at(ltm::example_time(1)).to_string()}).out,
              HasSubstr("12:26:40.200000/0"));
}

TEST_F(ListAndExport, NamesWhatIsNotThere) {
  const RunResult result = ls({"Vision/Depth"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("Vision/Depth"));
}

TEST_F(ListAndExport, ExportsOnceAndThenNeedsForce) {
  const RunResult first = run_engram({"export", store_, "--to", "csv", "-o", out_});
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_THAT(first.out, HasSubstr("120 snapshots with 120 instances: 2 files"));
  EXPECT_THAT(first.out, HasSubstr("120  texts"));
  const RunResult second = run_engram({"export", store_, "--to", "csv", "-o", out_});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.err, HasSubstr("--force"));
  EXPECT_EQ(run_engram({"export", store_, "--to", "csv", "-o", out_, "--force"}).exit_code, 0);
}

TEST_F(ListAndExport, RefusesFormatsThatThereAreNot) {
  EXPECT_EQ(run_engram({"export", store_, "--to", "pdf", "-o", out_}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(out_));
}

}  // namespace
}  // namespace engram::cli
