// SPDX-License-Identifier: Apache-2.0
#include "server/access/audit_log.h"

#include <unistd.h>

#include <filesystem>

#include "ltm/core/file.h"
#include "server/access/audit_check.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::server {
namespace {

namespace fs = std::filesystem;

/// A log without records, on the memory's file system where there is one.
class EmptyLog {
 public:
  EmptyLog() : folder_(root() / ("engram_audit_fuzz_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    const Status made = AuditLog::create(path());
    ENGRAM_CHECK(made.ok(), "{}", made.message());
  }
  ~EmptyLog() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  EmptyLog(const EmptyLog&) = delete;
  EmptyLog& operator=(const EmptyLog&) = delete;

  [[nodiscard]] fs::path path() const { return folder_ / "audit.log"; }

 private:
  static fs::path root() {
    return fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
  }

  fs::path folder_;
};

}  // namespace
}  // namespace engram::server

/// A log that no server wrote is never whole, and verifying it comes to an end.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::server;
  static const EmptyLog log;
  const Status written = replace_file(log.path(), as_bytes(fuzzed_text(data, size)));
  ENGRAM_CHECK(written.ok(), "{}", written.message());
  const auto report = check_audit_log(log.path(), AuditLog::key_path(log.path()), {}, {});
  ENGRAM_CHECK(report.ok(), "{}", report.status().message());
  ENGRAM_CHECK(report->is_whole() == (size == 0), "{} of {} lines are whole", report->whole,
               report->lines);
  return 0;
}
