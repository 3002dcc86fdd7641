// SPDX-License-Identifier: Apache-2.0
// What the faults brought to light, each in its shortest form.
#include <gtest/gtest.h>

#include "ltm/core/file.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm::faults {
namespace {

/// Appends example snapshots [0, count) with a number that tells one round from the next, seals.
void record(const std::filesystem::path& store, int64_t count, int64_t round) {
  const auto writer = *StoreWriter::open(store, {});
  for (int64_t i = 0; i < count; ++i) {
    Snapshot snapshot = example_snapshot(example_entity(), i);
    snapshot.instances.front().data.get_if<idf::Dict>()->set("round", round);
    ASSERT_OK(writer->append({pack_snapshot(snapshot)}, nullptr));
  }
  ASSERT_OK(writer->seal());
}

TEST(Found, AnOlderFormDoesNotComeBackWhereAnUpdatedSnapshotIsDropped) {
  const ScratchDirectory scratch;
  const std::filesystem::path store = scratch / "store";
  ASSERT_OK(create_store(store));
  record(store, 4, 0);
  record(store, 4, 1);  // Updates every one of them.
  const auto file = temporary_file(store, ".model");
  ASSERT_OK(file);
  ASSERT_OK(replace_file(*file, as_bytes("weights")));
  ASSERT_OK(publish_model(store, example_entity(), 1, *file, example_latents(0, 4, 1)));
  const auto dropped = drop_recorded(store, example_entity(), {});
  ASSERT_OK(dropped);
  EXPECT_EQ(dropped->snapshots, 4u);
  const auto reader = StoreReader::open(store);
  ASSERT_OK(reader);
  const auto found = read_all(**reader, example_entity());
  ASSERT_OK(found);
  EXPECT_THAT(*found, testing::IsEmpty()) << "values of round 0 are back";
  EXPECT_EQ((*(*reader)->index(example_entity()))->size(), 4u) << "the latents are there";
}

}  // namespace
}  // namespace engram::ltm::faults
