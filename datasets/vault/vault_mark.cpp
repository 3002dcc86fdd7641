// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/vault_mark.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <vector>

#include "ltm/core/byte_fields.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"

namespace engram::datasets::vault {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMarkName = "engram.vault";
constexpr std::string_view kMarkMagic = "ENGRAMVM";
constexpr uint32_t kMarkVersion = 1;
/// Magic, version and ID.
constexpr uint64_t kMarkBytes = 8 + 4 + 16;

std::string printable_path(const fs::path& path) {
  return printable(path.string());
}

/// Of the mark, which anybody may have made as large as they like, no more than one has.
Result<std::vector<std::byte>> read_mark(const fs::path& vault) {
  ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(vault / kMarkName, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  std::vector<std::byte> bytes(std::min(size, kMarkBytes + 1));
  ENGRAM_RETURN_IF_ERROR(file.read_at(0, bytes));
  return bytes;
}

std::vector<std::byte> mark_of(const RandomId& vault) {
  std::vector<std::byte> bytes;
  FieldWriter out(bytes);
  out.bytes(as_bytes(kMarkMagic));
  out.number(kMarkVersion);
  out.bytes(vault);
  return bytes;
}

Status is_busy(const fs::path& vault) {
  return failed_precondition("vault '{}': another process is changing it", printable_path(vault));
}

void warn_of_no_lock(const fs::path& vault, const Status& why) {
  log::warning("vault '{}': nothing here can be locked, so only one process may change it: {}",
               printable_path(vault), why.message());
}

/// Gives a new file the name of the mark, which nobody else may have given to another meanwhile.
Status name_mark(const fs::path& made, const fs::path& vault) {
  const fs::path mark = vault / kMarkName;
  if (::link(made.c_str(), mark.c_str()) == 0) {
    ENGRAM_RETURN_IF_ERROR(remove_file(made));
    return sync_directory(vault);
  }
  const int error = errno;
  if (error == EEXIST) ENGRAM_RETURN_IF_ERROR(remove_file(made));
  // Whoever made it first has removed what was unfinished.
  if (error == EEXIST || error == ENOENT) return is_busy(vault);
  // File systems without second names, as FAT: this one may replace another.
  return publish_file(made, mark);
}

}  // namespace

Result<RandomId> read_vault_id(const fs::path& vault) {
  const auto bytes = read_mark(vault);
  if (!bytes.ok() && bytes.status().code() != StatusCode::kNotFound) return bytes.status();
  if (!bytes.ok())
    return not_found("'{}': is no vault, as there is no file '{}' in it", printable_path(vault),
                     kMarkName);
  FieldReader in(*bytes);
  const bool is_mark = as_text(in.bytes(kMarkMagic.size())) == kMarkMagic;
  const auto version = in.number<uint32_t>();
  if (is_mark && in.is_whole() && version > kMarkVersion)
    return failed_precondition(
        "vault '{}': has version {} of the format, this program reads up to {}",
        printable_path(vault), version, kMarkVersion);
  RandomId id{};
  in.fill(id);
  if (!is_mark || !in.is_whole() || in.rest() > 0 || version == 0)
    return data_loss("vault '{}': its file '{}' is damaged", printable_path(vault), kMarkName);
  return id;
}

Result<std::optional<File>> lock_vault_mark(const fs::path& vault) {
  const fs::path path = vault / kMarkName;
  auto file = File::open(path, File::Mode::kRead);
  if (file.status().code() == StatusCode::kNotFound) return std::optional<File>();
  ENGRAM_RETURN_IF_ERROR(file.status());
  auto is_locked = file->lock(false);
  // NFS locks only what may be written.
  if (!is_locked.ok()) {
    file = File::open(path, File::Mode::kWrite);
    if (file.ok()) is_locked = file->lock(false);
  }
  if (!file.ok() || !is_locked.ok()) {
    warn_of_no_lock(vault, file.ok() ? is_locked.status() : file.status());
    return std::optional<File>();
  }
  if (!*is_locked) return is_busy(vault);
  return std::optional(*std::move(file));
}

Result<File> make_vault_mark(const fs::path& vault, const RandomId& id, const fs::path& made,
                             bool replaces_damaged) {
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(made, File::Mode::kCreate));
  // Before it is the mark, so that nobody else's lock comes first.
  if (const auto is_locked = file.lock(false); !is_locked.ok())
    warn_of_no_lock(vault, is_locked.status());
  ENGRAM_RETURN_IF_ERROR(file.append(mark_of(id)));
  ENGRAM_RETURN_IF_ERROR(file.sync());
  ENGRAM_RETURN_IF_ERROR(replaces_damaged ? publish_file(made, vault / kMarkName)
                                          : name_mark(made, vault));
  return file;
}

}  // namespace engram::datasets::vault
