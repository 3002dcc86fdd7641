// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/new_file.h"

#include <fstream>

#include "ltm/core/check.h"
#include "ltm/core/log.h"

namespace engram::datasets {

namespace {

std::filesystem::path part_of(const std::filesystem::path& path) {
  return path.string() + ".part";
}

}  // namespace

Result<NewFile> NewFile::create(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::exists(path, error))
    return already_exists("'{}' is there, needs a name that is free", path.string());
  ENGRAM_RETURN_IF_ERROR(make_directories(std::filesystem::absolute(path).parent_path()));
  // An export that was killed may have left a file.
  ENGRAM_RETURN_IF_ERROR(remove_file(part_of(path)));
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(part_of(path), File::Mode::kCreate));
  return NewFile(path, std::move(file));
}

NewFile::~NewFile() {
  // The object was moved from, or the file is published.
  if (!file_ || path_.empty()) return;
  if (const Status status = remove_file(part_of(path_)); !status.ok())
    log::warning("an unfinished export stays: {}", status.message());
}

Status NewFile::append(std::string_view bytes) {
  ENGRAM_RETURN_IF_ERROR(file_->append(as_bytes(bytes)));
  size_ += bytes.size();
  return {};
}

Status NewFile::overwrite(uint64_t offset, std::string_view bytes) {
  ENGRAM_CHECK(offset + bytes.size() <= size_, "{} bytes at {} of {}", bytes.size(), offset, size_);
  std::fstream part(part_of(path_), std::ios::binary | std::ios::in | std::ios::out);
  part.seekp(static_cast<std::streamoff>(offset));
  part.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  part.close();
  return part ? Status() : unavailable("'{}': cannot write", part_of(path_).string());
}

Status NewFile::publish() {
  ENGRAM_RETURN_IF_ERROR(publish_file(part_of(path_), path_));
  file_.reset();
  return {};
}

}  // namespace engram::datasets
