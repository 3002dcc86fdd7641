// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/merged_snapshots.h"

#include <gmock/gmock.h>

#include "ltm/recording/recorder.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

using ltm::MemoryId;

const MemoryId kFast = *MemoryId::parse("Data/A/robot/fast");
const MemoryId kSlow = *MemoryId::parse("Data/A/robot/slow");

Time at(int index) {
  return time_from_ns(1'000'000'000 + int64_t{index} * 10'000'000);
}

class MergedSnapshotsTest : public testing::Test {
 protected:
  void SetUp() override {
    auto recorder = ltm::Recorder::open(scratch_ / "store", {});
    ASSERT_OK(recorder);
    // Entities are committed one after the other; time begins anew.
    for (int i = 0; i < 20; ++i)
      ASSERT_OK(recorder->commit({{{kFast, at(i), {{idf::Data(i), {}}}}}}));
    for (int i = 0; i < 20; i += 5)
      ASSERT_OK(recorder->commit({{{kSlow, at(i), {{idf::Data(100 + i), {}}}}}}));
    ASSERT_OK(recorder->close());
  }

  std::vector<double> merged(const char* query) {
    ltm::Recall recall(*ltm::StoreReader::open(scratch_ / "store"), {});
    auto walk = MergedSnapshots::create(recall, *ltm::Query::parse(query), {});
    EXPECT_OK(walk);
    std::vector<double> values;
    while (walk.ok()) {
      const auto item = walk->next();
      EXPECT_OK(item);
      if (!item.ok() || !*item) break;
      values.push_back(*(*item)->snapshot.instances[0].data.as_number());
    }
    return values;
  }

  ScratchDirectory scratch_;
};

TEST_F(MergedSnapshotsTest, GoesByTimeThenByName) {
  EXPECT_THAT(merged("@ 1000000000..1060000000"),
              testing::ElementsAre(0, 100, 1, 2, 3, 4, 5, 105, 6));
  EXPECT_EQ(merged("@ all").size(), 24u);
  EXPECT_THAT(merged("Data/A/robot/slow @ latest:2"), testing::ElementsAre(110, 115));
}

TEST_F(MergedSnapshotsTest, RefusesQueriesWithoutData) {
  ltm::Recall recall(*ltm::StoreReader::open(scratch_ / "store"), {});
  EXPECT_FAILS(MergedSnapshots::create(recall, *ltm::Query::parse("?ids @ all"), {}),
               StatusCode::kInvalidArgument, "IDs alone");
  EXPECT_FAILS(MergedSnapshots::create(recall, *ltm::Query::parse("Nothing @ all"), {}),
               StatusCode::kNotFound, "Nothing");
}

}  // namespace
}  // namespace engram::datasets
