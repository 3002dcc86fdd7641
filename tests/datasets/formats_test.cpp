// SPDX-License-Identifier: Apache-2.0
#include "datasets/formats.h"

#include <fstream>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

TEST(RecordingFormats, KnowFilesByHowTheyBegin) {
  const auto path = std::filesystem::path(ENGRAM_SOURCE_DIR) /
                    "tests/golden/mcap/OneMessage-ch-chx-mx-rch-rsh-st.mcap";
  const auto format = recognised_format(path);
  ASSERT_OK(format);
  EXPECT_EQ((*format)->name(), "mcap");
}

TEST(RecordingFormats, AreFoundByTheirNames) {
  for (const auto& format : all_recording_formats()) {
    const auto found = find_recording_format(format->name());
    ASSERT_OK(found);
    EXPECT_EQ(*found, format.get());
    EXPECT_FALSE(format->about().empty());
  }
  EXPECT_FAILS(find_recording_format("none"), StatusCode::kInvalidArgument, "mcap");
}

TEST(RecordingFormats, SayWhichThereAreWhereNoneFits) {
  const ScratchDirectory scratch;
  std::ofstream(scratch / "text") << "hello";
  EXPECT_FAILS(recognised_format(scratch / "text"), StatusCode::kInvalidArgument, "mcap");
  EXPECT_FAILS(recognised_format(scratch / "none"), StatusCode::kNotFound, "none");
}

}  // namespace
}  // namespace engram::datasets
