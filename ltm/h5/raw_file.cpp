// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/raw_file.h"

namespace engram::h5 {

namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 31;

}  // namespace

Result<RawFile> RawFile::open(const std::filesystem::path& path, uint64_t base) {
  ENGRAM_ASSIGN_OR_RETURN(engram::File file, engram::File::open(path, engram::File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  if (base > size) return data_loss("user block of {} bytes in a file of {}", base, size);
  return RawFile(std::move(file), base, size - base);
}

Result<RawBytes> RawFile::read(uint64_t offset, uint64_t size) const {
  if (size > kMaxFileBytes || offset > size_ || size > size_ - offset)
    return data_loss("offset {}: {} bytes announced, the file has {}", offset, size, size_);
  RawBytes bytes(size);
  ENGRAM_RETURN_IF_ERROR(file_.read_at(base_ + offset, bytes));
  return bytes;
}

}  // namespace engram::h5
