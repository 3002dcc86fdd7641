// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

/// A store of example snapshots and made-up latents of them.
class PublishFixture : public ::testing::Test {
 protected:
  PublishFixture() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  /// Snapshots [first, end) of the entity, sealed as one segment.
  void record(int64_t first, int64_t end, const MemoryId& entity = example_entity()) {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = first; i < end; ++i)
      ASSERT_OK(writer->append({packed_example(i, entity)}, nullptr));
    ASSERT_OK(writer->seal());
  }

  Status publish(int version, const std::vector<LatentSnapshot>& latents,
                 const MemoryId& entity = example_entity(),
                 uint64_t first_unseen_journal = UINT64_MAX) {
    const auto file = temporary_file(store_, ".model");
    const std::string text = "weights " + std::to_string(version) + " of " + entity.to_string();
    EXPECT_OK(replace_file(*file, as_bytes(text)));
    return publish_model(store_, entity, version, *file, latents, first_unseen_journal);
  }

  std::unique_ptr<StoreReader> open() { return *StoreReader::open(store_); }

  [[nodiscard]] size_t files_in(const char* folder) const {
    return static_cast<size_t>(
        std::distance(std::filesystem::directory_iterator(store_ / folder), {}));
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

}  // namespace engram::ltm
