// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "datasets/vault/vault_keys.h"
#include "ltm/core/file.h"

namespace engram::datasets::vault {

/// Where a vault and its keys are.
struct VaultPlaces {
  std::filesystem::path vault;  ///< A directory.
  std::filesystem::path keys;   ///< A file outside of it.
};

using EntityDay = std::pair<ltm::MemoryId, Day>;

/// The path of a file of the vault. It may still have the name that it had while it was written.
[[nodiscard]] std::filesystem::path day_file(const std::filesystem::path& vault,
                                             const RandomId& file);

/// Reads a key file without a lock.
/// Errors: those of read_secret_file and decode_keys, naming the file.
Result<VaultKeys> read_keys(const std::filesystem::path& keys);

/// Reads the keys of the vault that is there.
/// Errors: kFailedPrecondition if they are the keys of another vault, or lie inside the vault;
/// those of read_vault_id and read_keys.
Result<VaultKeys> read_keys_of(const VaultPlaces& places);

/// The files of days in a vault, by their names. Other files count for nothing.
struct VaultFiles {
  std::vector<RandomId> whole;
  std::vector<RandomId> unfinished;  ///< They have the name of files that are being written.
};
Result<VaultFiles> list_files(const std::filesystem::path& vault);

/// A vault that is changed. No other process changes it meanwhile.
///
/// What changes counts once commit() returns. A process that is killed at any moment leaves what
/// counted before or after, and files without keys, which the next one removes.
///
/// Threading: one thread. One per key file and one per vault, over all processes (file locks).
/// Source: docs/vault.md, section "Writing, kills and locks".
class VaultFolder {
 public:
  /// Opens a vault for more days, and makes vault and keys where there are none.
  /// Errors: kFailedPrecondition if vault and keys do not belong together, if one of them is
  /// missing, or if another process changes one of them; kAlreadyExists if the directory has other
  /// files; those of read_keys; kUnavailable.
  static Result<VaultFolder> open(const VaultPlaces& places);

  /// Opens the keys to destroy some of them. The vault need not be within reach, and nothing that
  /// is wrong with it keeps them from being opened, but for its being another one.
  /// Errors: those of open() that the key file has; kFailedPrecondition if the vault is another.
  static Result<VaultFolder> open_keys(const VaultPlaces& places);

  VaultFolder(VaultFolder&&) noexcept;
  /// Removes files that no commit made count.
  ~VaultFolder();

  [[nodiscard]] const VaultKeys& keys() const { return keys_; }
  /// False if files of destroyed days may be left in the vault: it is not there, or it cannot be
  /// read or changed.
  [[nodiscard]] bool is_within_reach() const { return is_within_reach_; }

  /// The path at which a new file is written.
  [[nodiscard]] std::filesystem::path new_file(const RandomId& file) const;

  [[nodiscard]] const std::filesystem::path& vault() const { return places_.vault; }

  /// Takes a finished new file, in place of that of the same entity and day.
  void put(const ltm::MemoryId& entity, Day day, const VaultDay& made);

  /// Notes that a day is the same although the store has it elsewhere now, or a redaction found it
  /// as it is. Needs a known day (checked).
  void keep(const ltm::MemoryId& entity, Day day, uint64_t source, uint64_t times);

  /// Notes whose copy this is.
  void describe(const std::string& store_id, ltm::SegmentTypes types);

  /// Plain bytes of the files that wait for a commit.
  [[nodiscard]] uint64_t waiting_bytes() const { return waiting_bytes_; }
  [[nodiscard]] size_t waiting() const { return waiting_.size(); }

  /// Forces new files to the disk, then their keys, and removes what they replace.
  /// Errors: kResourceExhausted if the disk is full, else kUnavailable.
  Status commit();

  /// Destroys the keys of days, and removes their files where they are within reach. Days without
  /// keys are left out. Files that cannot be removed are no error: they are noise now. A warning
  /// says so, and the vault is not within reach any more.
  /// Errors: those of replace_secret_file.
  Status destroy(const std::vector<EntityDay>& days, Time now);

 private:
  VaultFolder(VaultPlaces places, File lock) : places_(std::move(places)), lock_(std::move(lock)) {}

  static Result<VaultFolder> lock(const VaultPlaces& real);
  Status make_or_read_keys();
  Status make_or_check_vault();
  Status make_mark(bool replaces_damaged);
  Status clean();
  Status save();
  void lose_reach(const Status& why);
  Status remove_file_of(const RandomId& file) const;

  VaultPlaces places_;
  File lock_;  ///< Of the key file.
  std::optional<File> lock_of_mark_;
  std::optional<File> lock_of_new_mark_;  ///< If the mark was made, or written anew.
  VaultKeys keys_;
  bool is_within_reach_ = false;
  bool has_changes_ = false;
  std::vector<RandomId> waiting_;  ///< Files to be renamed.
  uint64_t waiting_bytes_ = 0;
};

}  // namespace engram::datasets::vault
