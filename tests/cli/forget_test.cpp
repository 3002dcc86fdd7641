// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class Forget : public ::testing::Test {
 protected:
  Forget() {
    EXPECT_OK(ltm::create_store(store_));
    const auto writer = *ltm::StoreWriter::open(store_, {});
    for (int64_t i = 0; i < 10; ++i) {
      EXPECT_OK(writer->append({ltm::packed_example(i)}, nullptr));
      if (i % 4 == 3) EXPECT_OK(writer->seal());
    }
    EXPECT_OK(writer->seal());
    EXPECT_OK(writer->append({ltm::packed_example(10)}, nullptr));
  }

  std::string config(const std::string& text) {
    const auto path = directory_.path() / "forget.yaml";
    std::ofstream(path) << text;
    return path.string();
  }

  [[nodiscard]] size_t snapshots() const {
    const auto reader = *ltm::StoreReader::open(store_);
    return (*reader->index(ltm::example_entity()))->size();
  }

  ScratchDirectory directory_;
  std::string store_ = (directory_.path() / "store").string();
};

TEST_F(Forget, ADryRunPrintsWhatTheRunThenDoes) {
  const std::string file = config("forget: {rules: [{older_than: 1d}]}");
  const RunResult dry = run_engram({"forget", store_, "--config", file, "--dry-run", "--json"});
  ASSERT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_EQ(snapshots(), 11u);
  const RunResult text = run_engram({"forget", store_, "--config", file, "--dry-run"});
  EXPECT_THAT(text.out, HasSubstr("10 older than"));
  EXPECT_THAT(text.out, HasSubstr("1 snapshots are not sealed yet and stay"));
  const RunResult done = run_engram({"forget", store_, "--config", file, "--yes", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const Json report = Json::parse(done.out);
  EXPECT_EQ(report["plan"]["entities"], Json::parse(dry.out)["plan"]["entities"]);
  EXPECT_EQ(report["plan"]["entities"][0]["times_ns"].size(), 10u);
  EXPECT_EQ(report["done"]["snapshots"], 10);
  EXPECT_LT(report["done"]["store_bytes_after"], report["done"]["store_bytes_before"]);
  EXPECT_EQ(snapshots(), 1u);
}

TEST_F(Forget, TakesNamedSnapshots) {
  const std::string id = ltm::example_entity().at(ltm::example_time(2)).to_string();
  const RunResult done = run_engram({"forget", store_, id, "--yes"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("1 snapshots forgotten"));
  EXPECT_EQ(snapshots(), 10u);
  const RunResult again = run_engram({"forget", store_, id, "--yes"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("names no snapshot"));
}

TEST_F(Forget, RefusesWhereNobodyCanBeAsked) {
  const RunResult done = run_engram({"forget", store_, "Vision"});
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_THAT(done.err, HasSubstr("--yes"));
  EXPECT_EQ(snapshots(), 11u);
}

TEST_F(Forget, RefusesWithoutAnythingToForget) {
  EXPECT_EQ(run_engram({"forget", store_, "--yes"}).exit_code, 2);
  const RunResult wrong =
      run_engram({"forget", store_, "--yes", "--config", config("forget: {rule: []}")});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("'rules'"));
}

TEST_F(Forget, AQuotaThatCannotBeMetIsAnError) {
  const std::string file = config("forget: {quota: {max_bytes: 1B}}");
  const RunResult done = run_engram({"forget", store_, "--config", file, "--yes"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.err, HasSubstr("the quota is not met"));
}

TEST_F(Forget, CompactJoinsSegments) {
  const RunResult done = run_engram({"compact", store_, "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(Json::parse(done.out)["segments_before"], 3);
  EXPECT_EQ(Json::parse(done.out)["segments_after"], 1);
  EXPECT_EQ(snapshots(), 11u);
  EXPECT_EQ(run_engram({"compact", store_, "--segment-size", "many"}).exit_code, 2);
  EXPECT_EQ(run_engram({"compact", store_, "--segment-size", "0MiB"}).exit_code, 2);
  EXPECT_EQ(run_engram({"compact", store_ + "none"}).exit_code, 1);
}

}  // namespace
}  // namespace engram::cli
