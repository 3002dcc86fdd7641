// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/wiped_file.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "ltm/core/file.h"
#include "ltm/core/printable.h"
#include "ltm/core/private_file.h"

namespace engram::datasets::vault {

namespace {

constexpr size_t kWipeBytes = 64 << 10;

std::filesystem::path beside(const std::filesystem::path& path, std::string_view suffix) {
  std::filesystem::path other = path;
  other += suffix;
  return other;
}

std::filesystem::path new_of(const std::filesystem::path& path) {
  return beside(path, ".replacing");
}

std::filesystem::path old_of(const std::filesystem::path& path) {
  return beside(path, ".replaced");
}

/// Overwrites all bytes of a file. Random bytes, because file systems keep zeros as holes.
Status overwrite(PrivateFile& file) {
  std::vector<std::byte> noise(kWipeBytes);
  for (uint64_t at = 0; at < file.size(); at += noise.size()) {
    ENGRAM_RETURN_IF_ERROR(fill_random(noise));
    const auto count = std::min<uint64_t>(file.size() - at, noise.size());
    ENGRAM_RETURN_IF_ERROR(file.write_at(at, std::span(noise).first(count)));
  }
  return file.sync();
}

Result<PrivateFile> open_to_overwrite(const std::filesystem::path& path) {
  return PrivateFile::open(path, PrivateFile::Mode::kOverwrite, SecretReaders::kOwner);
}

/// Overwrites and removes a file; ok where there is none.
Status wipe(const std::filesystem::path& path) {
  auto file = open_to_overwrite(path);
  if (file.status().code() == StatusCode::kNotFound) return {};
  ENGRAM_RETURN_IF_ERROR(file.status());
  ENGRAM_RETURN_IF_ERROR(overwrite(*file));
  return remove_file(path);
}

Status write_new(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  ENGRAM_ASSIGN_OR_RETURN(PrivateFile file, PrivateFile::create(path));
  ENGRAM_RETURN_IF_ERROR(file.write_at(0, bytes));
  return file.sync();
}

Status rename_error(const std::filesystem::path& path, int error) {
  const bool is_full = error == ENOSPC || error == EDQUOT;
  return Status(is_full ? StatusCode::kResourceExhausted : StatusCode::kUnavailable,
                fmt::format("'{}': cannot rename: {}", printable(path.string()),
                            std::generic_category().message(error)));
}

/// Renames `from` to `to` and overwrites what `to` held.
Status take_place(const std::filesystem::path& from, const std::filesystem::path& to) {
  const std::filesystem::path old = old_of(to);
  auto before = open_to_overwrite(to);
  const bool is_first = before.status().code() == StatusCode::kNotFound;
  // Old bytes that cannot be overwritten must not lose the name by which they can be found.
  if (!is_first) ENGRAM_RETURN_IF_ERROR(before.status());
  // The second name is there for the next run, should this one be killed before it has overwritten
  // the old bytes. File systems without such names do without.
  if (!is_first) static_cast<void>(::link(to.c_str(), old.c_str()));
  if (::rename(from.c_str(), to.c_str()) != 0) return rename_error(from, errno);
  ENGRAM_RETURN_IF_ERROR(sync_directory(to.parent_path()));
  if (!is_first) ENGRAM_RETURN_IF_ERROR(overwrite(*before));
  return remove_file(old);
}

}  // namespace

Result<SecretBytes> read_secret_file(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const PrivateFile file,
                          PrivateFile::open(path, PrivateFile::Mode::kRead, SecretReaders::kOwner));
  SecretBytes bytes(file.size());
  ENGRAM_ASSIGN_OR_RETURN(const size_t size, file.read(bytes));
  bytes.resize(size);
  return bytes;
}

Status replace_secret_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  ENGRAM_RETURN_IF_ERROR(wipe_leftovers(path));
  const std::filesystem::path made = new_of(path);
  Status status = write_new(made, bytes);
  if (status.ok()) status = take_place(made, path);
  // Either it has its name now, or its keys must not stay beside the others.
  const Status wiped = wipe_leftovers(path);
  return status.ok() ? wiped : status;
}

Status check_replaceable(const std::filesystem::path& path) {
  const Status opened = open_to_overwrite(path).status();
  return opened.code() == StatusCode::kNotFound ? Status() : opened;
}

Status wipe_leftovers(const std::filesystem::path& path) {
  ENGRAM_RETURN_IF_ERROR(wipe(new_of(path)));
  const std::filesystem::path old = old_of(path);
  // A kill before the rename left a second name of the file itself.
  std::error_code error;
  if (std::filesystem::equivalent(path, old, error)) return remove_file(old);
  return wipe(old);
}

}  // namespace engram::datasets::vault
