// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ltm/recording/recorder.h"
#include "ltm/store/store_reader.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class Redact : public ::testing::Test {
 protected:
  Redact() {
    auto recorder = *ltm::Recorder::open(store_, {});
    for (int i = 0; i < 6; ++i) {
      const auto image = ltm::testing::image_with_secret(64, 48, i % 2 == 0 ? 20 : -1, 5);
      EXPECT_OK(
          recorder.commit({{{entity_, time_from_ns(i * int64_t{1'000'000}), {{image, {}}}}}}));
    }
    EXPECT_OK(recorder.close());
  }

  /// The detector as it is written on the command line.
  std::string detector(const std::string& mode = "finds") {
    const auto command = ltm::testing::marker_program(scratch_.path(), mode);
    return fmt::format("{{program: [{}]}}", fmt::join(command, ", "));
  }

  [[nodiscard]] int secrets() const {
    const auto reader = *ltm::StoreReader::open(store_);
    int count = 0;
    for (const ltm::SnapshotEntry& entry : **reader->index(entity_))
      count += ltm::testing::has_secret(
          (*reader->read_recorded(entity_, entry)).instances[0].data.get<idf::NdArray>());
    return count;
  }

  ltm::MemoryId entity_ = *ltm::MemoryId::parse("Vision/RGB/head/cam");
  ScratchDirectory scratch_;
  std::string store_ = (scratch_.path() / "store").string();
};

TEST_F(Redact, ADryRunTellsWhatTheRunThenDoes) {
  const RunResult dry = run_engram(
      {"redact", store_, "--detector", detector(), "--hold", "0s", "--dry-run", "--json"});
  ASSERT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_EQ(Json::parse(dry.out)["entities"][0]["redacted"], 3);
  EXPECT_EQ(secrets(), 3);
  const RunResult done = run_engram({"redact", store_, "Vision", "--detector", detector(), "--hold",
                                     "0s", "--action", "fill", "--yes"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("6 snapshots looked at, 3 redacted, 0 dropped"));
  EXPECT_THAT(done.out, HasSubstr("erasures/000001.json"));
  EXPECT_EQ(secrets(), 0);
}

TEST_F(Redact, FailsWhereADetectorGivesNoAnswer) {
  const RunResult done = run_engram(
      {"redact", store_, "--detector", detector("dies"), "--timeout", "500ms", "--yes", "--json"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.err, HasSubstr("snapshots are as they were, since the detector gave no answer"));
  EXPECT_GE(Json::parse(done.out)["entities"][0]["unanswered"], 1);
  EXPECT_EQ(secrets(), 3);
}

TEST_F(Redact, RefusesWhatMakesNoSense) {
  EXPECT_EQ(run_engram({"redact", store_, "--yes"}).exit_code, 2);
  EXPECT_EQ(run_engram({"redact", store_, "--detector", "people"}).exit_code, 2);
  EXPECT_EQ(run_engram({"redact", store_, "--detector", "people", "--json"}).exit_code, 2);
  const RunResult unknown = run_engram({"redact", store_, "--detector", "peple", "--yes"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("found detector 'peple'"));
  EXPECT_EQ(
      run_engram({"redact", store_, "--detector", "people", "--grow", "-1", "--yes"}).exit_code, 2);
  EXPECT_EQ(
      run_engram({"redact", store_, "--detector", "people", "--action", "blur", "--yes"}).exit_code,
      2);
  EXPECT_EQ(
      run_engram({"redact", store_, "--detector", "{onnx: /no/such.onnx}", "--yes"}).exit_code, 1);
  EXPECT_EQ(
      run_engram({"redact", store_, "Nobody/a/b/c", "--detector", "people", "--dry-run"}).exit_code,
      1);
}

}  // namespace
}  // namespace engram::cli
