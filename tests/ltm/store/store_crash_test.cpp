// SPDX-License-Identifier: Apache-2.0
// Writers that are killed: what they acknowledged is there (docs/design.md, section 4).
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <thread>

#include "ltm/core/log.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

/// Appends example snapshots from `first` on, without end; reports each acknowledged one.
[[noreturn]] void write_forever(const std::filesystem::path& store, int64_t first, int report,
                                uint64_t seal_bytes) {
  auto writer =
      StoreWriter::open(store, {.durability = Durability::kNone, .seal_bytes = seal_bytes});
  if (!writer.ok()) ::_exit(3);
  for (int64_t i = first;; ++i) {
    if (!(*writer)->append({packed_example(i)}, nullptr).ok()) ::_exit(4);
    if (::write(report, &i, sizeof(i)) != sizeof(i)) ::_exit(5);
  }
}

/// Runs a writer for `run` and kills it. The last index that it acknowledged, else `first` - 1.
int64_t run_and_kill(const std::filesystem::path& store, int64_t first, uint64_t seal_bytes,
                     std::chrono::microseconds run) {
  int ends[2] = {-1, -1};
  ENGRAM_CHECK(::pipe(ends) == 0, "no pipe");
  const pid_t child = ::fork();
  ENGRAM_CHECK(child >= 0, "no process");
  if (child == 0) {
    ::close(ends[0]);
    write_forever(store, first, ends[1], seal_bytes);
  }
  ::close(ends[1]);
  // Nothing is measured before the child has begun.
  int64_t last = first - 1, index = 0;
  if (::read(ends[0], &index, sizeof(index)) == sizeof(index)) last = index;
  std::jthread killer([child, run] {
    std::this_thread::sleep_for(run);
    ::kill(child, SIGKILL);
  });
  while (::read(ends[0], &index, sizeof(index)) == sizeof(index)) last = index;
  killer.join();
  int outcome = 0;
  ::waitpid(child, &outcome, 0);
  EXPECT_TRUE(WIFSIGNALED(outcome)) << "the writer failed: " << WEXITSTATUS(outcome);
  ::close(ends[0]);
  return last;
}

/// The number of snapshots in the store, which must be the first ones, undamaged.
int64_t expect_whole(const std::filesystem::path& store, int64_t min_count) {
  const auto reader = StoreReader::open(store);
  EXPECT_OK(reader);
  if (!reader.ok()) return -1;
  EXPECT_EQ((*reader)->damaged_places(), 0u);
  const auto found = read_all(**reader, example_entity());
  EXPECT_OK(found);
  if (!found.ok()) return -1;
  const auto count = static_cast<int64_t>(found->size());
  EXPECT_GE(count, min_count);
  for (int64_t i = 0; i < count; ++i)
    EXPECT_EQ((*found)[static_cast<size_t>(i)], example_snapshot(example_entity(), i));
  return count;
}

TEST(StoreCrash, LosesNothingAcknowledgedWhereTheWriterIsKilled) {
  const ScratchDirectory scratch;
  ASSERT_OK(create_store(scratch / "store"));
  int64_t next = 0;
  for (int round = 0; round < 5; ++round) {
    const int64_t last =
        run_and_kill(scratch / "store", next, 1 << 30, std::chrono::milliseconds(30));
    EXPECT_GE(last, next) << "the writer did nothing";
    next = expect_whole(scratch / "store", last + 1);
    ASSERT_GE(next, 0);
  }
}

TEST(StoreCrash, LosesNothingAcknowledgedWhereTheWriterIsKilledWhileSealing) {
  const ScratchDirectory scratch;
  ASSERT_OK(create_store(scratch / "store"));
  std::mt19937 random(51);
  int64_t next = 0;
  for (int round = 0; round < 30; ++round) {
    const std::chrono::microseconds run(random() % 20'000);
    const int64_t last = run_and_kill(scratch / "store", next, 2000, run);
    next = expect_whole(scratch / "store", last + 1);
    ASSERT_GE(next, 0);
  }
  // The next writer removes what was left behind.
  ASSERT_OK(StoreWriter::open(scratch / "store", {}));
  const auto manifest = read_manifest(scratch / "store");
  ptrdiff_t files = 0;
  for (const char* folder : {"segments", "tmp"})
    files += std::distance(std::filesystem::directory_iterator(scratch / "store" / folder), {});
  EXPECT_EQ(files, static_cast<ptrdiff_t>(manifest->segments.size()));
}

}  // namespace
}  // namespace engram::ltm
