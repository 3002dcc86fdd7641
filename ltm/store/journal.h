// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/core/file.h"

namespace engram::ltm {

/// Append-only file of checksummed frames: where acknowledged data lives first.
///
/// Threading: one thread.
/// Source: docs/format.md, section "Journal".
class Journal {
 public:
  /// "journal/000001.log" of journal 1.
  [[nodiscard]] static std::filesystem::path file_name(uint64_t number);

  /// Makes a new, empty journal file. Errors: kAlreadyExists, kUnavailable, kResourceExhausted.
  static Result<Journal> create(const std::filesystem::path& store, uint64_t number);

  /// Writes the frames with one system call. After an error nothing of them is in the file.
  /// Errors: kResourceExhausted, kUnavailable.
  Status append(std::span<const std::vector<std::byte>> payloads);

  /// Forces what was appended to the disk.
  Status sync() { return file_.sync(); }

  [[nodiscard]] uint64_t size_bytes() const { return size_; }
  [[nodiscard]] uint64_t number() const { return number_; }

  /// Bytes that a frame adds to its payload.
  static constexpr uint64_t kFrameOverheadBytes = 16;

 private:
  Journal(File file, uint64_t number, uint64_t size)
      : file_(std::move(file)), number_(number), size_(size) {}

  File file_;
  uint64_t number_;
  uint64_t size_;
  bool is_broken_ = false;
};

/// What a file of frames starts with.
inline constexpr std::string_view kJournalMagic = "ENGRAMJ1";

/// Frames as they stand in a file, for other logs of the same form.
/// Errors: kInvalidArgument where a payload is too large.
Result<std::vector<std::byte>> encode_journal_frames(
    std::span<const std::vector<std::byte>> payloads);

/// What a walk over a journal met beside whole frames.
struct JournalScan {
  uint64_t frames = 0;
  /// Bytes at the end that are no whole frame: an append that was never acknowledged.
  uint64_t torn_bytes = 0;
  /// These bytes are a frame of full size that is not what its checksum says: an append of which
  /// not everything reached the disk, or acknowledged data that was damaged.
  bool torn_may_be_damage = false;
  /// Damaged places with whole frames behind them: acknowledged data was there.
  uint64_t damaged = 0;
};

/// Calls `visit` with the offset and payload of each whole frame, in order. Safe on hostile bytes.
/// A frame that fails its checksum is skipped and counted; the walk goes on at the next whole one.
/// Errors: kDataLoss where the file is no journal; kUnavailable; those of `visit`.
Result<JournalScan> scan_journal(
    const std::filesystem::path& file,
    const std::function<Status(uint64_t offset, const Buffer& payload)>& visit);

/// The same for a file that need not be a journal any more: whole frames are looked for from its
/// first byte on, and a broken beginning counts as a damaged place.
Result<JournalScan> salvage_journal(
    const std::filesystem::path& file,
    const std::function<Status(uint64_t offset, const Buffer& payload)>& visit);

/// Reads the payload of the frame at `offset`. Errors: kDataLoss.
Result<Buffer> read_journal_frame(const File& file, uint64_t offset);

/// Numbers of the journals of a store, ascending.
Result<std::vector<uint64_t>> list_journals(const std::filesystem::path& store);

}  // namespace engram::ltm
