// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <filesystem>

#include "datasets/vault/day_records.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::datasets::vault {
namespace {

namespace fs = std::filesystem;

/// One file of a vault, on the memory's file system where there is one.
class OneFile {
 public:
  OneFile() : folder_(root() / ("engram_vault_fuzz_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    about_.key = *SecretKey::random();
    about_.file.fill(std::byte{7});
  }
  ~OneFile() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  OneFile(const OneFile&) = delete;
  OneFile& operator=(const OneFile&) = delete;

  /// Reads all of the file; says how it ends.
  [[nodiscard]] Status read() const {
    static const auto entity = *ltm::MemoryId::from_names({"Body", "Arm", "left", "arm"});
    ENGRAM_ASSIGN_OR_RETURN(DayReader reader, DayReader::open(path(), entity, 18'000, about_));
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, reader.next());
      if (!snapshot) return {};
    }
  }

  void put(std::string_view bytes) const {
    const Status written = replace_file(path(), as_bytes(bytes));
    ENGRAM_CHECK(written.ok(), "{}", written.message());
  }

  void seal(std::string_view plain) const {
    fs::remove(path());
    auto file = *SealedFileWriter::create(path(), about_.file, about_.key);
    ENGRAM_CHECK(file.append(as_bytes(plain)).ok() && file.finish().ok(), "cannot write");
  }

 private:
  [[nodiscard]] fs::path path() const { return folder_ / to_text(about_.file); }

  static fs::path root() {
    return fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
  }

  fs::path folder_;
  VaultDay about_;
};

}  // namespace
}  // namespace engram::datasets::vault

/// Bytes that nobody sealed never read. Bytes that a liar sealed read, or are damaged.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  static const datasets::vault::OneFile file;
  const auto text = fuzzed_text(data, size);
  file.put(text);
  ENGRAM_CHECK(file.read().code() == StatusCode::kDataLoss, "bytes without a seal were read");
  if (text.empty()) return 0;
  file.seal(text);
  const Status read = file.read();
  ENGRAM_CHECK(read.ok() || read.code() == StatusCode::kDataLoss, "{}", read.to_string());
  return 0;
}
