// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/core/file.h"

namespace engram::ltm {

/// An append-only file of checksummed frames. Acknowledged data is stored here first.
///
/// Threading: one thread.
/// Source: docs/format.md, section "Journal".
class Journal {
 public:
  /// The path of a journal relative to the store: "journal/000001.log" for number 1.
  [[nodiscard]] static std::filesystem::path file_name(uint64_t number);

  /// Creates a new, empty journal file. Errors: kAlreadyExists, kUnavailable, kResourceExhausted.
  static Result<Journal> create(const std::filesystem::path& store, uint64_t number);

  /// Writes the frames with one system call. After an error the file contains none of them.
  /// Errors: kResourceExhausted, kUnavailable.
  Status append(std::span<const std::vector<std::byte>> payloads);

  /// Forces all appended frames to the disk (fdatasync), and then notes beside the file that its
  /// first `bytes` bytes are there, so that somebody who finds it shorter knows that it was cut.
  /// Threading: one thread, which may be another than that of append.
  Status sync(uint64_t bytes);

  /// Removes a journal and its note.
  static Status remove(const std::filesystem::path& store, uint64_t number);

  [[nodiscard]] uint64_t size_bytes() const { return size_; }
  [[nodiscard]] uint64_t number() const { return number_; }

  /// Size of a frame's header, in bytes. Each frame also has up to 7 bytes of padding.
  static constexpr uint64_t kFrameOverheadBytes = 16;

 private:
  Journal(File file, uint64_t number, uint64_t size)
      : file_(std::move(file)), number_(number), size_(size) {}

  File file_;
  std::optional<File> mark_;  ///< The note of what was forced to the disk.
  uint64_t number_;
  uint64_t size_;
  bool is_broken_ = false;
};

/// The note of what was forced to the disk of a journal: "journal/000001.acked".
[[nodiscard]] std::filesystem::path acknowledged_mark_of(const std::filesystem::path& journal);

/// How many bytes of a journal were forced to the disk for certain; nothing where no note says it.
/// There may be more: the note is written afterwards, and is not forced to the disk itself.
[[nodiscard]] std::optional<uint64_t> acknowledged_bytes(const std::filesystem::path& journal);

/// The first bytes of every file of frames.
inline constexpr std::string_view kJournalMagic = "ENGRAMJ1";

/// Encodes payloads as the bytes of frames, for other logs that have the form of a journal.
/// Errors: kInvalidArgument if a payload is too large.
Result<std::vector<std::byte>> encode_journal_frames(
    std::span<const std::vector<std::byte>> payloads);

/// What a scan of a journal found besides whole frames.
struct JournalScan {
  uint64_t frames = 0;
  /// Bytes at the end of the file that are not a whole frame: of an append that was cut off, or of
  /// a file that was.
  uint64_t torn_bytes = 0;
  /// How many bytes were forced to the disk for certain, where that is known.
  std::optional<uint64_t> acknowledged_bytes;
  /// How many of these are missing at the end. They count as a damaged place.
  uint64_t missing_bytes = 0;
  /// The torn bytes contain a frame of full size whose content does not match its checksum. Either
  /// an append did not reach the disk completely, or acknowledged data was damaged.
  bool torn_may_be_damage = false;
  /// Number of damaged places that are followed by a whole frame, or that were forced to the disk.
  /// Each contained acknowledged data.
  uint64_t damaged = 0;
};

/// Calls `visit` with the offset and payload of each whole frame, in order. Safe on hostile bytes.
/// A frame whose checksum does not match is counted and skipped; the scan continues at the next
/// whole frame.
/// Errors: kDataLoss if the file is not a journal; kUnavailable; those of `visit`.
Result<JournalScan> scan_journal(
    const std::filesystem::path& file,
    const std::function<Status(uint64_t offset, const Buffer& payload)>& visit);

/// Like scan_journal, but for a file whose magic may be damaged. The search for whole frames starts
/// at the first byte, and a damaged magic counts as a damaged place.
Result<JournalScan> salvage_journal(
    const std::filesystem::path& file,
    const std::function<Status(uint64_t offset, const Buffer& payload)>& visit);

/// Reads the payload of the frame at `offset`. Errors: kDataLoss.
Result<Buffer> read_journal_frame(const File& file, uint64_t offset);

/// Lists the numbers of the journals in a store, in ascending order.
Result<std::vector<uint64_t>> list_journals(const std::filesystem::path& store);

/// Lists the numbers of the journals of which a note tells what was forced to the disk.
Result<std::vector<uint64_t>> list_acknowledged_marks(const std::filesystem::path& store);

}  // namespace engram::ltm
