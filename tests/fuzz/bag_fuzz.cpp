// SPDX-License-Identifier: Apache-2.0
#include <sys/mman.h>
#include <unistd.h>

#include <map>

#include "datasets/rosbag/rosbag_format.h"
#include "tests/fuzz/fuzz_check.h"

/// What a file gives is in the order of time, and commits.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::datasets;
  const int file = ::memfd_create("fuzz", 0);
  ENGRAM_CHECK(file >= 0 && ::write(file, data, size) == static_cast<ssize_t>(size), "no file");
  static const auto format = make_rosbag_format();
  const auto reader = format->open(fmt::format("/proc/self/fd/{}", file), {});
  std::map<ltm::MemoryId, Time> last;
  Time last_moment = Time::min();
  while (reader.ok()) {
    const auto moment = (*reader)->next();
    if (!moment.ok() || !*moment) break;
    const ltm::Commit& commit = (*moment)->commit;
    if (commit.updates.empty()) continue;
    const Status status = commit.check();
    ENGRAM_CHECK(status.ok(), "{}", status.message());
    for (const ltm::EntityUpdate& update : commit.updates) {
      ENGRAM_CHECK(update.time >= last_moment, "times go back");
      const auto [before, is_first] = last.try_emplace(update.entity, update.time);
      ENGRAM_CHECK(is_first || before->second < update.time, "times of an entity do not increase");
      before->second = last_moment = update.time;
    }
  }
  ::close(file);
  return 0;
}
