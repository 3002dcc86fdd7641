// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "ltm/store/checkpoint_file.h"
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

TEST_F(Forget, ErasesWhatIsInJournalsAndMadeOfItToo) {
  // One that was made of the third, and one of that.
  const auto made_of = [](int64_t index, int64_t origin) {
    ltm::PackedSnapshot made = ltm::packed_example(index);
    for (ltm::PackedInstance& instance : made.instances)
      instance.metadata.origin = ltm::example_entity().at(ltm::example_time(origin));
    return made;
  };
  {
    const auto writer = *ltm::StoreWriter::open(store_, {});
    ASSERT_OK(writer->append({made_of(11, 2), made_of(12, 11)}, nullptr));
    ASSERT_OK(writer->append({ltm::packed_example(13)}, nullptr));
  }
  const std::string id = ltm::example_entity().at(ltm::example_time(2)).to_string();
  const std::string unsealed = ltm::example_entity().at(ltm::example_time(10)).to_string();
  const RunResult done = run_engram({"forget", store_, id, unsealed, "--erase", "--yes", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const Json report = Json::parse(done.out);
  EXPECT_EQ(report["plan"]["entities"][0]["reasons"]["made of what goes"], 2);
  EXPECT_EQ(report["done"]["snapshots"], 4);
  EXPECT_EQ(snapshots(), 10u);
  const std::string file = report["done"]["erased"]["report"];
  std::ifstream kept(std::filesystem::path(store_) / file);
  const Json told = Json::parse(kept)["entities"];
  EXPECT_EQ(told, report["done"]["erased"]["entities"]);
  EXPECT_EQ(told[0]["id"], ltm::example_entity().to_string());
  EXPECT_EQ(told[0]["erased"], 4);
  EXPECT_EQ(run_engram({"check", store_}).exit_code, 0);
}

TEST_F(Forget, ErasesCheckpointsOfTheSameEntityAlone) {
  const auto other = *ltm::MemoryId::parse(ltm::example_entity().to_string() + "2");
  const auto own_file = ltm::checkpoint_file(store_, ltm::example_entity(), 7);
  const auto other_file = ltm::checkpoint_file(store_, other, 7);
  for (const auto& file : {own_file, other_file}) std::ofstream(file) << "weights";
  const std::string id = ltm::example_entity().at(ltm::example_time(2)).to_string();
  const RunResult done = run_engram({"forget", store_, id, "--erase", "--yes", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_FALSE(std::filesystem::exists(own_file));
  EXPECT_TRUE(std::filesystem::exists(other_file));
  const Json files = Json::parse(done.out)["done"]["erased"]["files_removed"];
  EXPECT_EQ(files, Json({"tmp/" + own_file.filename().string()}));
}

TEST_F(Forget, ErasesNothingWhereItIsBeingRecorded) {
  const auto writer = *ltm::StoreWriter::open(store_, {});
  const RunResult done = run_engram({"forget", store_, "Vision", "--erase", "--yes"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.err, HasSubstr("another process is writing to it"));
}

TEST_F(Forget, ErasesWhatKilledProcessesAndDamageLeft) {
  const auto in_store = [this](const char* file) { return std::filesystem::path(store_) / file; };
  for (const char* file : {"journal/000001.log.damaged", "segments/000099.h5", "tmp/1.x.h5"})
    std::ofstream(in_store(file)) << "a face";
  const RunResult done = run_engram({"forget", store_, "--erase", "--yes"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  for (const char* file : {"journal/000001.log.damaged", "segments/000099.h5"})
    EXPECT_FALSE(std::filesystem::exists(in_store(file))) << file;
  EXPECT_EQ(snapshots(), 11u);
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
