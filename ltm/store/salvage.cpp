// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/salvage.h"

#include <algorithm>
#include <set>

#include "ltm/codec/medium_decoder.h"
#include "ltm/core/file.h"
#include "ltm/store/frame.h"
#include "ltm/store/segment_walk.h"
#include "ltm/store/segment_writer.h"

namespace engram::ltm {

namespace {

/// Approximate max size of the snapshots that are held before they are written, in bytes.
constexpr uint64_t kHeldBytes = uint64_t{64} << 20;
/// Approximate size of the groups in which frames are appended to a journal, in bytes.
constexpr uint64_t kFramesBytes = uint64_t{1} << 20;

uint64_t size_of(const PackedSnapshot& snapshot) {
  uint64_t bytes = snapshot.raw_bytes;
  for (const PackedInstance& instance : snapshot.instances)
    for (const PackedMedium& medium : instance.value.media)
      bytes += medium.bytes.size() / (medium.group ? medium.group->count : 1);
  return bytes;
}

/// True if a group of images continues after this snapshot.
bool is_in_group(const std::map<MemoryId, RecordedEntity>& recorded, const MemoryId& entity) {
  const auto found = recorded.find(entity);
  if (found == recorded.end() || found->second.snapshots.empty()) return false;
  for (const PackedInstance& instance : found->second.snapshots.back().instances)
    for (const PackedMedium& medium : instance.value.media)
      if (medium.group && medium.group->index + 1 < medium.group->count) return true;
  return false;
}

/// True if a block of latents continues after this snapshot.
bool is_in_block(const std::vector<LatentSnapshot>& latents) {
  if (latents.empty()) return false;
  return std::ranges::any_of(latents.back().instances, [](const LatentInstance& instance) {
    return instance.latent.place.index + 1 < instance.latent.place.count;
  });
}

/// The size that a snapshot adds to the held ones. The bytes of a block count once; `codes` are the
/// codes already held.
uint64_t size_of(const LatentSnapshot& snapshot, std::set<const std::byte*>& codes) {
  uint64_t bytes = 0;
  for (const LatentInstance& instance : snapshot.instances) {
    const Buffer& code = instance.latent.code;
    bytes += sizeof(instance) + (codes.insert(code.data()).second ? code.size() : 0);
  }
  return bytes;
}

class SegmentSalvage {
 public:
  SegmentSalvage(SegmentReader& reader, const SegmentInfo& told, const SegmentTypes& types,
                 const std::filesystem::path& target, const std::function<std::string()>& next_file,
                 const std::stop_token& stop, SalvagedSegment& result)
      : reader_(reader),
        told_(told),
        target_(target),
        next_file_(next_file),
        stop_(stop),
        result_(result),
        types_(reader.types().value_or(types)) {}

  Status run() {
    for (const SegmentEntity& entity : told_.entities) ENGRAM_RETURN_IF_ERROR(salvage(entity));
    return write_recorded();
  }

 private:
  Status salvage(const SegmentEntity& told) {
    SalvagedSegment::Counts& counts = result_.entities[told.id];
    std::string reason;
    std::optional<Time> last;
    const auto lose = [&](uint64_t snapshots, const Status& why) {
      counts.lost += snapshots;
      if (reason.empty()) reason = why.message();
    };
    Status broken;  // An error of writing. Errors of reading only count as losses.
    const Status walked =
        walk_rows(reader_, told.id, [&](const RowSpan& span, const Status& times) -> Status {
          if (stop_.stop_requested()) return broken = cancelled("recover: stopped");
          if (!times.ok()) return lose(span.rows, times), Status();
          if (last && span.time <= *last)
            return lose(1, data_loss("row {} runs backwards in time", span.first)), Status();
          const Status read = collect(told.id, span);
          // Stop here: data that another installation can decode is not lost.
          if (read.code() == StatusCode::kFailedPrecondition) return broken = read;
          if (!read.ok()) return lose(1, read), Status();
          last = span.time;
          ++counts.saved;
          return has_room(told.id) ? Status() : broken = write(told.id);
        });
    ENGRAM_RETURN_IF_ERROR(broken);
    if (!walked.ok()) lose(0, walked);
    counts.lost = std::max(counts.lost, told.snapshots - std::min(told.snapshots, counts.saved));
    if (counts.lost > 0) tell(told.id, counts, reason);
    if (told_.kind == SegmentKind::kLatent) return write_latents(told.id);
    return keep_drops(told);
  }

  void tell(const MemoryId& entity, const SalvagedSegment::Counts& counts,
            const std::string& reason) {
    result_.findings.push_back(
        {Severity::kFault, told_.file, entity.to_string(),
         fmt::format("{} of {} {} are lost: {}", counts.lost, counts.lost + counts.saved,
                     told_.kind == SegmentKind::kLatent ? "snapshots of latents" : "snapshots",
                     reason),
         "none: nothing else holds them in this form"});
  }

  Status collect(const MemoryId& entity, const RowSpan& span) {
    if (told_.kind == SegmentKind::kLatent) {
      ENGRAM_ASSIGN_OR_RETURN(LatentSnapshot latent, reader_.read_latent(entity, span));
      held_bytes_ += size_of(latent, held_codes_);
      latents_.push_back(std::move(latent));
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(PackedSnapshot packed, reader_.read_recorded(entity, span));
    ENGRAM_RETURN_IF_ERROR(decode_groups(packed));
    held_bytes_ += size_of(packed);
    dropped_[entity].first += packed.dropped;
    dropped_[entity].second += packed.dropped_bytes;
    RecordedEntity& saved = recorded_[entity];
    if (saved.snapshots.empty()) saved.rules = rules_of(entity);
    saved.snapshots.push_back(std::move(packed));
    return {};
  }

  /// Decodes the groups of a snapshot to check them. Only later snapshots show whether other images
  /// of a group are lost; if so, the images are written as decoded.
  Status decode_groups(const PackedSnapshot& packed) {
    for (const PackedInstance& instance : packed.instances)
      for (const PackedMedium& medium : instance.value.media)
        if (medium.group) ENGRAM_RETURN_IF_ERROR(decoder_.decode(medium).status());
    return {};
  }

  /// Numbers keep their stored form.
  [[nodiscard]] SealRules rules_of(const MemoryId& entity) {
    const auto forms = reader_.forms(entity);
    return forms.ok() ? SealRules::columns(forms->columns) : SealRules();
  }

  /// True if more snapshots can be held. The limit is higher inside a group or block, because a
  /// group that is cut must be split into single images and a block that is cut must be stored
  /// twice.
  [[nodiscard]] bool has_room(const MemoryId& entity) const {
    const bool goes_on = is_in_group(recorded_, entity) || is_in_block(latents_);
    return held_bytes_ < (goes_on ? kMaxGroupBytes : kHeldBytes);
  }

  /// Keeps the count of dropped snapshots, even if the rows that recorded it are lost.
  Status keep_drops(const SegmentEntity& told) {
    const auto [dropped, bytes] = dropped_[told.id];
    const uint64_t left = told.dropped - std::min(told.dropped, dropped);
    if (left == 0) return {};
    recorded_[told.id].trailing_dropped = left;
    recorded_[told.id].trailing_dropped_bytes =
        told.dropped_bytes - std::min(told.dropped_bytes, bytes);
    return {};
  }

  Status write(const MemoryId& entity) {
    return told_.kind == SegmentKind::kLatent ? write_latents(entity) : write_recorded();
  }

  Status write_recorded() {
    if (recorded_.empty()) return {};
    const std::string file = next_file_();
    ENGRAM_ASSIGN_OR_RETURN(SegmentInfo info,
                            write_recorded_segment(target_ / file, recorded_, types_));
    recorded_.clear();
    return finish(std::move(info), file);
  }

  Status write_latents(const MemoryId& entity) {
    if (latents_.empty()) return {};
    const std::string file = next_file_();
    ENGRAM_ASSIGN_OR_RETURN(SegmentInfo info,
                            write_latent_segment(target_ / file, entity, latents_));
    latents_.clear();
    return finish(std::move(info), file);
  }

  Status finish(SegmentInfo info, const std::string& file) {
    held_bytes_ = 0;
    held_codes_.clear();
    info.file = file;
    result_.made.push_back(std::move(info));
    ENGRAM_ASSIGN_OR_RETURN(File made, File::open(target_ / file, File::Mode::kRead));
    return made.sync();
  }

  SegmentReader& reader_;
  const SegmentInfo& told_;
  const std::filesystem::path& target_;
  const std::function<std::string()>& next_file_;
  const std::stop_token& stop_;
  SalvagedSegment& result_;
  SegmentTypes types_;
  MediumDecoder decoder_;
  std::map<MemoryId, RecordedEntity> recorded_;
  /// Dropped snapshots counted in rows, and their bytes.
  std::map<MemoryId, std::pair<uint64_t, uint64_t>> dropped_;
  std::vector<LatentSnapshot> latents_;
  std::set<const std::byte*> held_codes_;  ///< Codes of `latents_`.
  uint64_t held_bytes_ = 0;
};

/// The result for a completely unreadable segment.
SalvagedSegment all_lost(const SegmentInfo& told, const Status& why) {
  SalvagedSegment result;
  for (const SegmentEntity& entity : told.entities)
    result.entities[entity.id].lost = entity.snapshots;
  result.findings.push_back({Severity::kFault, told.file, "", "is lost: " + why.message(),
                             "none: nothing else holds what was in it in this form"});
  return result;
}

}  // namespace

Result<SalvagedSegment> salvage_segment(const std::filesystem::path& source,
                                        const SegmentInfo& told, const SegmentTypes& types,
                                        const std::filesystem::path& target,
                                        const std::function<std::string()>& next_file,
                                        const std::stop_token& stop) {
  const auto reader = SegmentReader::open(source / told.file);
  if (reader.status().code() == StatusCode::kFailedPrecondition) return reader.status();
  if (!reader.ok()) return all_lost(told, reader.status());
  SalvagedSegment result;
  ENGRAM_RETURN_IF_ERROR(
      SegmentSalvage(**reader, told, types, target, next_file, stop, result).run());
  return result;
}

Result<SalvagedJournal> copy_journal(const std::filesystem::path& source,
                                     const std::filesystem::path& target, uint64_t number,
                                     std::optional<Time> latest) {
  SalvagedJournal result;
  ENGRAM_ASSIGN_OR_RETURN(Journal journal, Journal::create(target, number));
  std::vector<std::vector<std::byte>> frames;
  uint64_t bytes = 0;
  const auto append = [&]() -> Status {
    bytes = 0;
    return journal.append(std::exchange(frames, {}));
  };
  const auto add = [&](uint64_t, const Buffer& payload) -> Status {
    const auto packed = decode_frame(payload);
    if (!packed.ok()) return ++result.undecodable, Status();
    if (latest && !packed->instances.empty() && packed->time > *latest)
      return ++result.too_late[packed->entity], Status();
    if (!packed->instances.empty()) ++result.snapshots[packed->entity];
    frames.emplace_back(payload.bytes().begin(), payload.bytes().end());
    bytes += payload.size();
    return bytes < kFramesBytes ? Status() : append();
  };
  ENGRAM_ASSIGN_OR_RETURN(result.scan, salvage_journal(source / Journal::file_name(number), add));
  ENGRAM_RETURN_IF_ERROR(append());
  ENGRAM_RETURN_IF_ERROR(journal.sync(journal.size_bytes()));
  return result;
}

}  // namespace engram::ltm
