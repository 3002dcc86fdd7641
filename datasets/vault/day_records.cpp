// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/day_records.h"

#include <algorithm>

#include "ltm/core/byte_fields.h"
#include "ltm/core/printable.h"
#include "ltm/idf/binary.h"
#include "ltm/store/checksum.h"
#include "ltm/store/frame.h"

namespace engram::datasets::vault {

namespace {

enum RecordKind : uint8_t { kColumns = 1, kGroup = 2, kSnapshot = 3, kEnd = 4 };

/// The frame in a snapshot's record begins at a multiple of this, so that its arrays need not be
/// copied.
constexpr size_t kAlignment = 8;

/// A record is read in pieces, each as large as all before.
constexpr size_t kFirstPiece = 1 << 20;

/// So much waits at most for the ends of groups.
constexpr uint64_t kWaitingBytes = uint64_t{128} << 20;
constexpr size_t kWaitingSnapshots = 4096;

/// Of one flush, far more than any has.
constexpr size_t kMaxGroups = 1 << 20;

/// Says of which group a medium is. The frame has it without bytes.
struct GroupUse {
  uint32_t instance = 0;
  uint32_t medium = 0;
  uint32_t number = 0;
  uint32_t index = 0;
  uint32_t count = 0;
};

size_t padding(size_t size) {
  return (kAlignment - size % kAlignment) % kAlignment;
}

/// Of a snapshot as it waits. The bytes of groups are counted once for all of their images.
uint64_t bytes_of(const ltm::PackedSnapshot& packed) {
  uint64_t bytes = bytes_without_media(packed);
  for (const ltm::PackedInstance& instance : packed.instances)
    for (const ltm::PackedMedium& medium : instance.value.media)
      if (!medium.group) bytes += medium.bytes.size();
  return bytes;
}

template <typename Visit>
void for_each_group(ltm::PackedSnapshot& packed, const Visit& visit) {
  for (size_t i = 0; i < packed.instances.size(); ++i) {
    auto& media = packed.instances[i].value.media;
    for (size_t j = 0; j < media.size(); ++j)
      if (media[j].group) visit(static_cast<uint32_t>(i), static_cast<uint32_t>(j), media[j]);
  }
}

std::vector<GroupUse> read_uses(FieldReader& in) {
  std::vector<GroupUse> uses;
  const auto count = in.number<uint32_t>();
  for (uint32_t i = 0; i < count && in.is_whole(); ++i) {
    GroupUse use;
    for (uint32_t* field : {&use.instance, &use.medium, &use.number, &use.index, &use.count})
      *field = in.number<uint32_t>();
    uses.push_back(use);
  }
  return uses;
}

}  // namespace

uint64_t bytes_without_media(const ltm::PackedSnapshot& packed) {
  uint64_t media = 0;
  for (const ltm::PackedInstance& instance : packed.instances)
    for (const ltm::PackedMedium& medium : instance.value.media)
      media += idf::size_bytes(medium.type, medium.shape).value_or(0);
  return packed.raw_bytes > media ? packed.raw_bytes - media : 0;
}

Status DayWriter::put_columns(const ColumnPaths& paths) {
  if (paths.empty()) return {};
  idf::List list;
  for (const std::string& path : paths) list.emplace_back(path);
  ENGRAM_ASSIGN_OR_RETURN(const auto payload, idf::encode(idf::Data(std::move(list))));
  return write_record(kColumns, payload);
}

Status DayWriter::put(VaultSnapshot snapshot) {
  for_each_group(snapshot.packed, [this](uint32_t, uint32_t, const ltm::PackedMedium& medium) {
    const auto [place, is_new] = groups_.try_emplace(medium.bytes.data());
    Group& group = place->second;
    if (is_new) {
      group.bytes = medium.bytes;
      group.count = medium.group->count;
      waiting_bytes_ += medium.bytes.size();
      ++open_groups_;
    }
    ++group.seen;
    if (!group.has_ended && medium.group->index + 1 == medium.group->count) {
      group.has_ended = true;
      --open_groups_;
    }
  });
  waiting_bytes_ += bytes_of(snapshot.packed);
  waiting_.push_back(std::move(snapshot));
  const bool is_full = waiting_bytes_ >= kWaitingBytes || waiting_.size() >= kWaitingSnapshots;
  return open_groups_ == 0 || is_full ? flush() : Status();
}

Status DayWriter::flush() {
  next_number_ = 0;
  for (VaultSnapshot& snapshot : waiting_) ENGRAM_RETURN_IF_ERROR(write_snapshot(snapshot));
  waiting_.clear();
  groups_.clear();
  waiting_bytes_ = 0;
  open_groups_ = 0;
  return {};
}

Status DayWriter::write_snapshot(VaultSnapshot& snapshot) {
  ltm::PackedSnapshot& packed = snapshot.packed;
  std::vector<GroupUse> uses;
  Status status;
  for_each_group(packed, [&](uint32_t instance, uint32_t index, ltm::PackedMedium& medium) {
    if (!status.ok()) return;
    Group& group = groups_.at(medium.bytes.data());
    if (group.seen != group.count) {
      auto alone = pack_alone(medium, decoder_);
      status = alone.status();
      if (alone.ok()) medium = *std::move(alone);
      return;
    }
    status = write_group(group);
    if (!status.ok()) return;
    uses.push_back({instance, index, *group.number, medium.group->index, medium.group->count});
    medium.group.reset();
    medium.bytes = {};
  });
  ENGRAM_RETURN_IF_ERROR(status);
  std::vector<std::byte> payload;
  FieldWriter out(payload);
  out.number(static_cast<uint32_t>(uses.size()));
  for (const GroupUse& use : uses)
    for (const uint32_t field : {use.instance, use.medium, use.number, use.index, use.count})
      out.number(field);
  const bool is_recorded = snapshot.reconstructed.is<idf::None>();
  std::vector<std::byte> note;
  if (!is_recorded) {
    ENGRAM_ASSIGN_OR_RETURN(note, idf::encode(snapshot.reconstructed));
  }
  out.sized(note);
  payload.resize(payload.size() + padding(payload.size()));
  ENGRAM_ASSIGN_OR_RETURN(const auto frame, encode_frame(packed));
  out.bytes(frame);
  if (about_.snapshots == 0) about_.first = packed.time;
  about_.last = packed.time;
  ++about_.snapshots;
  about_.instances += packed.instances.size();
  about_.raw_bytes += packed.raw_bytes;
  about_.reconstructed += is_recorded ? 0 : 1;
  return write_record(kSnapshot, payload);
}

Status DayWriter::write_group(Group& group) {
  if (group.number) return {};
  group.number = next_number_++;
  std::vector<std::byte> payload;
  payload.reserve(group.bytes.size() + sizeof(uint32_t));
  FieldWriter out(payload);
  out.number(*group.number);
  out.bytes(group.bytes.bytes());
  return write_record(kGroup, payload);
}

Status DayWriter::write_record(uint8_t kind, std::span<const std::byte> payload) {
  std::vector<std::byte> head;
  FieldWriter out(head);
  out.number(kind);
  out.number(static_cast<uint64_t>(payload.size()));
  const std::array<uint64_t, 3> chained{about_.digest, kind, ltm::checksum(payload)};
  about_.digest = ltm::checksum(std::as_bytes(std::span(chained)));
  ENGRAM_RETURN_IF_ERROR(file_.append(head));
  return file_.append(payload);
}

Status DayWriter::finish(VaultDay& about) {
  ENGRAM_RETURN_IF_ERROR(flush());
  const uint64_t snapshots = about_.snapshots;
  ENGRAM_RETURN_IF_ERROR(write_record(kEnd, std::as_bytes(std::span(&snapshots, 1))));
  ENGRAM_RETURN_IF_ERROR(file_.finish());
  about.snapshots = about_.snapshots;
  about.instances = about_.instances;
  about.first = about_.first;
  about.last = about_.last;
  about.raw_bytes = about_.raw_bytes;
  about.reconstructed = about_.reconstructed;
  about.digest = about_.digest;
  about.file_bytes = file_.file_bytes();
  return {};
}

Result<DayReader> DayReader::open(const std::filesystem::path& path, const ltm::MemoryId& entity,
                                  Day day, const VaultDay& about) {
  ENGRAM_ASSIGN_OR_RETURN(SealedFileReader file,
                          SealedFileReader::open(path, about.file, about.key));
  return DayReader(path, std::move(file), entity, day);
}

Status DayReader::broken(std::string_view what) const {
  return data_loss("'{}': {}", printable(path_.string()), what);
}

Result<DayReader::Record> DayReader::read_record() {
  std::array<std::byte, 9> head{};
  ENGRAM_RETURN_IF_ERROR(file_.read(head));
  FieldReader in(head);
  Record record;
  record.kind = in.number<uint8_t>();
  const auto size = in.number<uint64_t>();
  // Whoever sealed the file may have lied.
  if (size > file_.bytes_left()) return broken("a record is longer than its file");
  // Nor is there memory for a file that is large because nothing is in it: seals come first.
  std::vector<std::byte> payload;
  while (payload.size() < size) {
    const size_t known = payload.size();
    payload.resize(std::min(static_cast<size_t>(size), std::max(2 * known, kFirstPiece)));
    ENGRAM_RETURN_IF_ERROR(file_.read(std::span(payload).subspan(known)));
  }
  record.payload = Buffer::take(std::move(payload));
  return record;
}

Result<std::optional<VaultSnapshot>> DayReader::next() {
  while (!has_ended_) {
    ENGRAM_ASSIGN_OR_RETURN(const Record record, read_record());
    FieldReader in(record.payload.bytes());
    switch (record.kind) {
      case kColumns:
        ENGRAM_RETURN_IF_ERROR(take_columns(record.payload));
        break;
      case kGroup: {
        const auto number = in.number<uint32_t>();
        if (number == 0) groups_.clear();
        if (!in.is_whole() || number != groups_.size() || number >= kMaxGroups)
          return broken("a group of images has another number than needed");
        groups_.push_back(record.payload.slice(sizeof(number), in.rest()));
        break;
      }
      case kSnapshot: {
        ENGRAM_ASSIGN_OR_RETURN(VaultSnapshot snapshot, snapshot_of(record.payload));
        ENGRAM_RETURN_IF_ERROR(check_snapshot(snapshot.packed));
        return std::optional(std::move(snapshot));
      }
      case kEnd:
        ENGRAM_RETURN_IF_ERROR(check_end(record.payload));
        has_ended_ = true;
        break;
      default:
        return broken(fmt::format("has a record of kind {}", record.kind));
    }
  }
  return std::optional<VaultSnapshot>();
}

Status DayReader::take_columns(const Buffer& payload) {
  const auto data = idf::decode(payload);
  if (!data.ok()) return broken(data.status().message());
  const auto* paths = data->get_if<idf::List>();
  if (paths == nullptr) return broken("its columns are no list");
  for (const idf::Data& path : *paths) {
    const auto* text = path.get_if<std::string>();
    if (text == nullptr) return broken("its columns are no texts");
    columns_.insert(*text);
  }
  return {};
}

Result<VaultSnapshot> DayReader::snapshot_of(const Buffer& payload) {
  FieldReader in(payload.bytes());
  const auto uses = read_uses(in);
  const auto note = in.sized();
  in.bytes(padding(payload.size() - in.rest()));
  if (!in.is_whole()) return broken("a snapshot is cut off");
  VaultSnapshot snapshot;
  if (!note.empty()) {
    auto reconstructed = idf::decode(Buffer::copy(note));
    if (!reconstructed.ok()) return broken(reconstructed.status().message());
    snapshot.reconstructed = *std::move(reconstructed);
  }
  auto frame = ltm::decode_frame(payload.slice(payload.size() - in.rest(), in.rest()));
  if (!frame.ok()) return broken(frame.status().message());
  snapshot.packed = *std::move(frame);
  auto& instances = snapshot.packed.instances;
  for (const GroupUse& use : uses) {
    if (use.instance >= instances.size() ||
        use.medium >= instances[use.instance].value.media.size() || use.number >= groups_.size() ||
        use.index >= use.count || use.count > ltm::kMaxGroupImages)
      return broken("a snapshot is of a group of images that is not there");
    ltm::PackedMedium& medium = instances[use.instance].value.media[use.medium];
    medium.bytes = groups_[use.number];
    medium.group = {use.index, use.count};
  }
  return snapshot;
}

Status DayReader::check_snapshot(const ltm::PackedSnapshot& packed) {
  const std::string id = packed.entity.at(packed.time).printable();
  if (packed.entity != entity_ || day_of(packed.time) != day_)
    return broken(fmt::format("has '{}', which is of another entity or day", id));
  if (packed.instances.empty()) return broken(fmt::format("'{}' has no instances", id));
  if (last_ && packed.time <= *last_) return broken(fmt::format("'{}' is out of order", id));
  last_ = packed.time;
  ++snapshots_;
  return {};
}

Status DayReader::check_end(const Buffer& payload) const {
  FieldReader in(payload.bytes());
  if (in.number<uint64_t>() != snapshots_ || !in.is_whole() || in.rest() > 0)
    return broken("has another number of snapshots than its end says");
  if (file_.bytes_left() > 0) return broken("goes on behind its end");
  return {};
}

}  // namespace engram::datasets::vault
