// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "datasets/vault/sealed_file.h"
#include "datasets/vault/vault_keys.h"
#include "ltm/codec/medium_decoder.h"
#include "ltm/store/packed_snapshot.h"

namespace engram::datasets::vault {

/// Paths of numbers that a store keeps in compressed columns.
using ColumnPaths = std::set<std::string, std::less<>>;

/// A snapshot in a vault.
struct VaultSnapshot {
  ltm::PackedSnapshot packed;
  /// Empty if this is what was recorded. Else where the value comes from: {"model", "errors":
  /// [{"image_mse", "number_mse"}]} with an entry for each instance.
  idf::Data reconstructed = {};
};

/// The plain size of what is no medium of a snapshot: that is held decoded, unlike media.
[[nodiscard]] uint64_t bytes_without_media(const ltm::PackedSnapshot& packed);

/// Writes the snapshots of one entity and day.
///
/// Groups of images are kept as they are, but not those with images of other days: destroying the
/// key of one day would leave its images in the file of the next. Images of such groups are taken
/// out, without further loss. So a group must be seen as a whole before it is written.
/// Memory: the snapshots that share groups, about 128 MiB at most; where groups of several
/// image members never end together, what waits by then is taken out of its groups.
///
/// Threading: one thread. The file must outlive it.
/// Source: docs/vault.md, section "What a file of a day holds".
class DayWriter {
 public:
  explicit DayWriter(SealedFileWriter& file) : file_(file) {}

  /// The first record, if the entity has such numbers.
  Status put_columns(const ColumnPaths& paths);

  /// Snapshots come in the order of time.
  /// Errors: kResourceExhausted, kUnavailable; kDataLoss if a group does not decode;
  /// kInvalidArgument if a value nests too deep.
  Status put(VaultSnapshot snapshot);

  /// Ends the file. Sets what a key file says of its content.
  Status finish(VaultDay& about);

 private:
  struct Group {
    Buffer bytes;
    uint32_t count = 0;
    uint32_t seen = 0;
    bool has_ended = false;
    std::optional<uint32_t> number;  ///< In the file, once it is written.
  };

  Status flush();
  Status write_snapshot(VaultSnapshot& snapshot);
  Status write_group(Group& group);
  Status write_record(uint8_t kind, std::span<const std::byte> payload);

  SealedFileWriter& file_;
  std::vector<VaultSnapshot> waiting_;
  uint64_t waiting_bytes_ = 0;
  std::map<const std::byte*, Group> groups_;  ///< Of what waits, by the place of their bytes.
  size_t open_groups_ = 0;
  uint32_t next_number_ = 0;  ///< Of the groups written since the last flush began.
  ltm::MediumDecoder decoder_;
  VaultDay about_;
};

/// Reads what DayWriter wrote, one snapshot after the other.
///
/// Memory: the groups that are in use. Threading: one thread.
class DayReader {
 public:
  /// Errors, also of next(): kDataLoss naming the file and what does not fit.
  static Result<DayReader> open(const std::filesystem::path& path, const ltm::MemoryId& entity,
                                Day day, const VaultDay& about);

  /// The next snapshot; nothing after the last one.
  Result<std::optional<VaultSnapshot>> next();

  /// Known once the first snapshot was read.
  [[nodiscard]] const ColumnPaths& columns() const { return columns_; }

 private:
  DayReader(std::filesystem::path path, SealedFileReader file, ltm::MemoryId entity, Day day)
      : path_(std::move(path)), file_(std::move(file)), entity_(std::move(entity)), day_(day) {}

  struct Record {
    uint8_t kind = 0;
    Buffer payload;
  };

  Result<Record> read_record();
  Result<VaultSnapshot> snapshot_of(const Buffer& payload);
  Status check_snapshot(const ltm::PackedSnapshot& packed);
  Status check_end(const Buffer& payload) const;
  Status take_columns(const Buffer& payload);
  [[nodiscard]] Status broken(std::string_view what) const;

  std::filesystem::path path_;
  SealedFileReader file_;
  ltm::MemoryId entity_;
  Day day_;
  std::vector<Buffer> groups_;
  ColumnPaths columns_;
  uint64_t snapshots_ = 0;
  std::optional<Time> last_;
  bool has_ended_ = false;
};

}  // namespace engram::datasets::vault
