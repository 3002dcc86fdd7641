// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/journal.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string_view>

#include "ltm/core/log.h"
#include "ltm/store/checksum.h"

namespace engram::ltm {

namespace {

constexpr std::string_view kFileMagic = kJournalMagic;
constexpr uint32_t kFrameMagic = 0x4d524645;  // "EFRM"
constexpr size_t kAlignment = 8;

struct FrameHeader {
  uint32_t magic;
  uint32_t payload_bytes;
  uint64_t checksum;
};
static_assert(sizeof(FrameHeader) == Journal::kFrameOverheadBytes);

/// Frames start at multiples of 8, so that ndarrays inside stay aligned.
constexpr uint64_t padded(uint64_t size) {
  return (size + kAlignment - 1) / kAlignment * kAlignment;
}

/// The payload of the frame at `at`, or nullopt if no whole frame starts there.
std::optional<std::span<const std::byte>> frame_at(std::span<const std::byte> bytes, uint64_t at) {
  FrameHeader header;
  if (bytes.size() - at < sizeof(header)) return std::nullopt;
  std::memcpy(&header, bytes.data() + at, sizeof(header));
  if (header.magic != kFrameMagic || header.payload_bytes > bytes.size() - at - sizeof(header))
    return std::nullopt;
  const auto payload = bytes.subspan(at + sizeof(header), header.payload_bytes);
  if (checksum(payload) != header.checksum) return std::nullopt;
  return payload;
}

std::optional<uint64_t> next_frame(std::span<const std::byte> bytes, uint64_t from) {
  for (uint64_t at = padded(from); at + sizeof(FrameHeader) <= bytes.size(); at += kAlignment)
    if (frame_at(bytes, at)) return at;
  return std::nullopt;
}

/// True if a frame of full size starts at `at` and only one of its fields or its payload is
/// damaged. A killed append leaves the beginning of a frame, never a complete frame with wrong
/// content, so such a frame is probably damaged data rather than a torn append.
bool is_damaged_frame(std::span<const std::byte> bytes, uint64_t at) {
  FrameHeader header;
  if (bytes.size() - at < sizeof(header)) return false;
  std::memcpy(&header, bytes.data() + at, sizeof(header));
  const auto rest = bytes.subspan(at + sizeof(header));
  const bool fits = header.payload_bytes <= rest.size();
  if (header.magic == kFrameMagic && fits) return true;
  const auto is_payload = [&](uint32_t size) {
    return size <= rest.size() && checksum(rest.subspan(0, size)) == header.checksum;
  };
  if (is_payload(header.payload_bytes)) return true;
  if (header.magic != kFrameMagic) return false;
  // A flipped bit in the size moves the end of the payload, so each size that differs in one bit is
  // tried.
  for (uint32_t bit = 1; bit != 0; bit <<= 1)
    if (is_payload(header.payload_bytes ^ bit)) return true;
  return false;
}

using FrameVisit = std::function<Status(uint64_t offset, const Buffer& payload)>;

/// What lies beside a journal, and is replaced as a whole.
struct Mark {
  std::array<char, 8> magic{};
  uint64_t bytes = 0;
  uint64_t checksum = 0;
};
constexpr std::string_view kMarkMagic = "ENGRAMA1";

Mark mark_of(uint64_t bytes) {
  Mark mark;
  std::ranges::copy(kMarkMagic, mark.magic.begin());
  mark.bytes = bytes;
  mark.checksum = checksum(std::as_bytes(std::span(&mark.bytes, 1)));
  return mark;
}

/// Counts what was forced to the disk and is not there.
JournalScan with_mark(JournalScan scan, uint64_t file_bytes, std::optional<uint64_t> mark) {
  scan.acknowledged_bytes = mark;
  if (!mark) return scan;
  // A cut in the zeros behind the last frame cost nothing.
  const uint64_t whole = padded(file_bytes - scan.torn_bytes);
  if (*mark > whole) {
    scan.missing_bytes = *mark - whole;
    ++scan.damaged;
    scan.torn_may_be_damage = false;  // It was, and is counted.
  }
  return scan;
}

/// Visits the frames from byte `at` on.
Result<JournalScan> walk_frames(const Buffer& content, uint64_t at, JournalScan scan,
                                const FrameVisit& visit) {
  const auto bytes = content.bytes();
  while (at < bytes.size()) {
    const auto payload = frame_at(bytes, at);
    if (!payload) {
      const auto next = next_frame(bytes, at + 1);
      if (!next) {
        scan.torn_bytes = bytes.size() - at;
        scan.torn_may_be_damage = is_damaged_frame(bytes, at);
        return scan;
      }
      ++scan.damaged;
      at = *next;
      continue;
    }
    ENGRAM_RETURN_IF_ERROR(visit(at, content.slice(at + sizeof(FrameHeader), payload->size())));
    ++scan.frames;
    at = std::min<uint64_t>(padded(at + sizeof(FrameHeader) + payload->size()), bytes.size());
  }
  return scan;
}

/// True for an incomplete magic: the process was killed while it created the journal, and nothing
/// was acknowledged yet.
bool is_unfinished(std::string_view text) {
  return text.size() < kFileMagic.size() && kFileMagic.starts_with(text);
}

}  // namespace

std::filesystem::path Journal::file_name(uint64_t number) {
  return fmt::format("journal/{:06}.log", number);
}

Result<Journal> Journal::create(const std::filesystem::path& store, uint64_t number) {
  const std::filesystem::path path = store / file_name(number);
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kCreate));
  ENGRAM_RETURN_IF_ERROR(file.append(as_bytes(kFileMagic)));
  ENGRAM_RETURN_IF_ERROR(file.sync());
  ENGRAM_RETURN_IF_ERROR(sync_directory(path.parent_path()));
  Journal journal(std::move(file), number, kFileMagic.size());
  // Opened now, because a late note must not make the file again once the journal was removed.
  auto mark = File::open(acknowledged_mark_of(path), File::Mode::kWrite);
  if (mark.ok())
    journal.mark_ = std::move(mark).value();
  else
    log::warning("'{}': what is forced to the disk cannot be noted beside it", path.string());
  return journal;
}

Status Journal::sync(uint64_t bytes) {
  ENGRAM_RETURN_IF_ERROR(file_.sync());
  // The note is advice: what is acknowledged does not depend on it.
  if (!mark_) return {};
  const Mark mark = mark_of(bytes);
  if (mark_->write_at(0, std::as_bytes(std::span(&mark, 1))).ok()) return {};
  mark_.reset();
  log::warning("'{}': what is forced to the disk cannot be noted beside it any more",
               file_.path().string());
  return {};
}

Status Journal::remove(const std::filesystem::path& store, uint64_t number) {
  const std::filesystem::path file = store / file_name(number);
  // The note goes first: alone it would tell of a journal that is missing.
  ENGRAM_RETURN_IF_ERROR(remove_file(acknowledged_mark_of(file)));
  return remove_file(file);
}

std::filesystem::path acknowledged_mark_of(const std::filesystem::path& journal) {
  return std::filesystem::path(journal).replace_extension(".acked");
}

std::optional<uint64_t> acknowledged_bytes(const std::filesystem::path& journal) {
  const auto content = read_file(acknowledged_mark_of(journal));
  Mark mark;
  if (!content.ok() || content->size() != sizeof(mark)) return std::nullopt;
  std::memcpy(&mark, content->data(), sizeof(mark));
  const Mark wanted = mark_of(mark.bytes);
  if (mark.magic != wanted.magic || mark.checksum != wanted.checksum) return std::nullopt;
  return mark.bytes;
}

Status Journal::append(std::span<const std::vector<std::byte>> payloads) {
  if (is_broken_)
    return unavailable("'{}': an earlier write failed half-way; open the store again",
                       file_.path().string());
  auto encoded = encode_journal_frames(payloads);
  if (!encoded.ok()) return encoded.status().with_context(file_.path().string());
  const std::vector<std::byte>& frames = *encoded;
  if (Status status = file_.append(frames); !status.ok()) {
    // The partly written frames were never acknowledged. Without the cut they would be a torn frame
    // in the middle of the file.
    is_broken_ = !file_.truncate(size_).ok();
    return status;
  }
  size_ += frames.size();
  return {};
}

Result<std::vector<std::byte>> encode_journal_frames(
    std::span<const std::vector<std::byte>> payloads) {
  std::vector<std::byte> frames;
  for (const std::vector<std::byte>& payload : payloads) {
    if (payload.size() > UINT32_MAX)
      return invalid_argument("a snapshot of {} bytes, at most 4 GiB fit", payload.size());
    const FrameHeader header{kFrameMagic, static_cast<uint32_t>(payload.size()), checksum(payload)};
    const auto header_bytes = std::as_bytes(std::span(&header, 1));
    frames.insert(frames.end(), header_bytes.begin(), header_bytes.end());
    frames.insert(frames.end(), payload.begin(), payload.end());
    frames.resize(padded(frames.size()));
  }
  return frames;
}

Result<JournalScan> scan_journal(const std::filesystem::path& file, const FrameVisit& visit) {
  // Read first: a writer beside may append meanwhile.
  const auto mark = acknowledged_bytes(file);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer content, read_file(file));
  const std::string_view text = as_text(content.bytes());
  JournalScan scan;
  if (is_unfinished(text)) {
    scan.torn_bytes = text.size();
  } else {
    if (!text.starts_with(kFileMagic))
      return data_loss("'{}' is no journal: needs '{}' at its start", file.string(), kFileMagic);
    ENGRAM_ASSIGN_OR_RETURN(scan, walk_frames(content, kFileMagic.size(), scan, visit));
  }
  return with_mark(scan, text.size(), mark);
}

Result<JournalScan> salvage_journal(const std::filesystem::path& file, const FrameVisit& visit) {
  const auto mark = acknowledged_bytes(file);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer content, read_file(file));
  const std::string_view text = as_text(content.bytes());
  JournalScan scan;
  if (is_unfinished(text)) {
    scan.torn_bytes = text.size();
    return with_mark(scan, text.size(), mark);
  }
  const bool has_magic = text.starts_with(kFileMagic);
  scan.damaged = has_magic ? 0 : 1;
  const uint64_t first =
      has_magic ? kFileMagic.size() : next_frame(content.bytes(), 0).value_or(text.size());
  ENGRAM_ASSIGN_OR_RETURN(scan, walk_frames(content, first, scan, visit));
  return with_mark(scan, text.size(), mark);
}

Result<Buffer> read_journal_frame(const File& file, uint64_t offset) {
  FrameHeader header;
  std::vector<std::byte> head(sizeof(header));
  ENGRAM_RETURN_IF_ERROR(file.read_at(offset, head));
  std::memcpy(&header, head.data(), sizeof(header));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  if (header.magic != kFrameMagic || header.payload_bytes > size - offset - sizeof(header))
    return data_loss("'{}': no frame at byte {}", file.path().string(), offset);
  std::vector<std::byte> payload(header.payload_bytes);
  ENGRAM_RETURN_IF_ERROR(file.read_at(offset + sizeof(header), payload));
  if (checksum(payload) != header.checksum)
    return data_loss("'{}': the frame at byte {} fails its checksum", file.path().string(), offset);
  return Buffer::take(std::move(payload));
}

namespace {

Result<std::vector<uint64_t>> list_numbers(const std::filesystem::path& store,
                                           std::string_view extension) {
  std::vector<uint64_t> numbers;
  std::error_code error;
  // Some copies of a store omit empty folders.
  if (!std::filesystem::exists(store / "journal", error)) return numbers;
  for (const auto& entry : std::filesystem::directory_iterator(store / "journal", error)) {
    const std::string name = entry.path().filename().string();
    uint64_t number = 0;
    const auto [end, problem] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (problem == std::errc() && std::string_view(end) == extension) numbers.push_back(number);
  }
  if (error) return unavailable("'{}': {}", (store / "journal").string(), error.message());
  std::ranges::sort(numbers);
  return numbers;
}

}  // namespace

Result<std::vector<uint64_t>> list_journals(const std::filesystem::path& store) {
  return list_numbers(store, ".log");
}

Result<std::vector<uint64_t>> list_acknowledged_marks(const std::filesystem::path& store) {
  return list_numbers(store, ".acked");
}

}  // namespace engram::ltm
