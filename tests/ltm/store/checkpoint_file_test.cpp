// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/checkpoint_file.h"

#include <algorithm>

#include "ltm/core/file.h"
#include "ltm/store/manifest.h"
#include "ltm/store/orphans.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

MemoryId id(const std::string& text) {
  return *MemoryId::parse(text);
}

TEST(CheckpointFile, OutlivesTheNextWriter) {
  const ScratchDirectory scratch;
  const std::filesystem::path store = scratch / "store";
  ASSERT_OK(create_store(store));
  const auto file = checkpoint_file(store, id("Vision/RGB/head/cam"), 0x12ab);
  EXPECT_EQ(file.filename(), "Vision.RGB.head.cam.00000000000012ab.checkpoint");
  ASSERT_OK(replace_file(file, as_bytes("state")));
  ASSERT_OK(replace_file(store / "tmp" / "rest", as_bytes("rest")));
  ASSERT_OK(StoreWriter::open(store, {}));
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(store / "tmp" / "rest"));
  const auto notes = *find_orphans(store);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].severity, Severity::kNote);
  EXPECT_EQ(notes[0].file, "tmp/" + file.filename().string());
}

TEST(CheckpointFile, LeavesTheHistoryToTheNextNight) {
  const ScratchDirectory scratch;
  const std::filesystem::path store = scratch / "store";
  ASSERT_OK(create_store(store));
  const auto kept = history_file(store, id("A/B/C/D")), gone = history_file(store, id("A/B/C/E"));
  EXPECT_EQ(kept.filename(), "A.B.C.D.history");
  for (const auto& file : {kept, gone}) ASSERT_OK(replace_file(file, as_bytes("{}")));
  ASSERT_OK(StoreWriter::open(store, {}));
  EXPECT_TRUE(find_orphans(store)->empty());
  ASSERT_OK(remove_checkpoints(store, id("A/B/C/D")));
  ASSERT_OK(remove_checkpoints_of_others(store, {id("A/B/C/D")}));
  EXPECT_TRUE(std::filesystem::exists(kept));
  EXPECT_FALSE(std::filesystem::exists(gone));
}

TEST(CheckpointFile, IsRemovedWithThoseOfItsEntity) {
  const ScratchDirectory scratch;
  const std::filesystem::path store = scratch.path();
  ASSERT_OK(make_directories(store / "tmp"));
  const auto first = checkpoint_file(store, id("A/B/C/D"), 1);
  const auto second = checkpoint_file(store, id("A/B/C/D"), 2);
  const auto longer = checkpoint_file(store, id("A/B/C/D.E"), 1);
  auto unfinished = first;
  unfinished += ".new";
  const auto all = {first, second, longer, unfinished};
  for (const auto& file : all) ASSERT_OK(replace_file(file, as_bytes("state")));
  const auto there = [&] {
    std::string text;
    for (const auto& file : all) text += std::filesystem::exists(file) ? '1' : '0';
    return text;
  };
  ASSERT_OK(remove_checkpoints(store, id("A/B/C/D"), {&second, 1}));
  EXPECT_EQ(there(), "0110");
  ASSERT_OK(remove_checkpoints_of_others(store, {id("A/B/C/D"), id("A/B/C/D.E")}));
  EXPECT_EQ(there(), "0110");
  ASSERT_OK(remove_checkpoints_of_others(store, {id("A/B/C/D")}));
  EXPECT_EQ(there(), "0100");
  ASSERT_OK(remove_checkpoints(store, id("A/B/C/D")));
  EXPECT_EQ(there(), "0000");
}

}  // namespace
}  // namespace engram::ltm
