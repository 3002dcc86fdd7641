// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/access_log.h"

#include <unistd.h>

#include <filesystem>
#include <vector>

#include "ltm/store/journal.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::ltm {
namespace {

namespace fs = std::filesystem;

/// A store with nothing but a log of reads, on the memory's file system where there is one.
class Folder {
 public:
  Folder() : path_(root() / ("engram_access_fuzz_" + std::to_string(::getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_ / "access");
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  /// Nothing but this log is left of what was there before.
  void hold(std::span<const std::byte> log) const {
    for (const auto& entry : fs::directory_iterator(path_ / "access")) fs::remove(entry.path());
    const Status written = replace_file(path_ / "access" / "1-1.log", log);
    ENGRAM_CHECK(written.ok(), "{}", written.message());
  }

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  static fs::path root() {
    return fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
  }

  fs::path path_;
};

/// The payload of one frame whose checksum is right, behind the start of a log.
std::vector<std::byte> framed(std::span<const std::byte> payload) {
  const std::vector<std::vector<std::byte>> payloads{{payload.begin(), payload.end()}};
  const auto frames = encode_journal_frames(payloads);
  ENGRAM_CHECK(frames.ok(), "{}", frames.status().message());
  const auto magic = as_bytes(kJournalMagic);
  std::vector<std::byte> log(magic.begin(), magic.end());
  log.insert(log.end(), frames->begin(), frames->end());
  return log;
}

}  // namespace
}  // namespace engram::ltm

/// What a log says is the same after it was merged. The first byte says whether the rest is the
/// whole file or what a frame holds.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::ltm;
  static const Folder folder;
  if (size < 1) return 0;
  const auto bytes = as_bytes(fuzzed_text(data + 1, size - 1));
  if (data[0] % 2 == 0)
    folder.hold(bytes);
  else
    folder.hold(framed(bytes));
  const AccessTable before = read_accesses(folder.path());
  const Status merged = merge_accesses(folder.path());
  ENGRAM_CHECK(merged.ok(), "{}", merged.message());
  const AccessTable after = read_accesses(folder.path());
  ENGRAM_CHECK(before.all() == after.all(), "{} snapshots, merged {}", before.size(), after.size());
  return 0;
}
