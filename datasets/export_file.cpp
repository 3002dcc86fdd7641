// SPDX-License-Identifier: Apache-2.0
#include "datasets/export_file.h"

#include <system_error>

#include "ltm/core/log.h"

namespace engram::datasets {

namespace {

constexpr size_t kBlockBytes = 1 << 16;

std::filesystem::path part_of(const std::filesystem::path& path) {
  return path.string() + ".part";
}

Result<File> create_part(const std::filesystem::path& path) {
  ENGRAM_RETURN_IF_ERROR(make_directories(path.parent_path()));
  // An export that was killed may have left a file.
  ENGRAM_RETURN_IF_ERROR(remove_file(part_of(path)));
  return File::open(part_of(path), File::Mode::kCreate);
}

}  // namespace

Result<ExportFile> ExportFile::create(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(File file, create_part(path));
  return ExportFile(path, std::move(file));
}

ExportFile::~ExportFile() {
  // The object was moved from, or the file is closed.
  if (!file_ || path_.empty()) return;
  if (const Status status = remove_file(part_of(path_)); !status.ok())
    log::warning("an unfinished export stays: {}", status.message());
}

Status ExportFile::write(std::string_view text) {
  waiting_ += text;
  return waiting_.size() < kBlockBytes ? Status() : flush();
}

Status ExportFile::flush() {
  bytes_ += waiting_.size();
  ENGRAM_RETURN_IF_ERROR(file_->append(as_bytes(waiting_)));
  waiting_.clear();
  return {};
}

Status ExportFile::close(ExportReport& report) {
  ENGRAM_RETURN_IF_ERROR(flush());
  ENGRAM_RETURN_IF_ERROR(publish_file(part_of(path_), path_));
  file_.reset();
  ++report.files;
  report.bytes += bytes_;
  return {};
}

Status write_export_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                         ExportReport& report) {
  {
    ENGRAM_ASSIGN_OR_RETURN(File file, create_part(path));
    ENGRAM_RETURN_IF_ERROR(file.append(bytes));
  }
  std::error_code error;
  std::filesystem::rename(part_of(path), path, error);
  if (error) return unavailable("'{}': cannot rename: {}", path.string(), error.message());
  ++report.files;
  report.bytes += bytes.size();
  return {};
}

}  // namespace engram::datasets
