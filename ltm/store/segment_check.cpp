// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_check.h"

#include <algorithm>
#include <set>

#include "ltm/store/checksum.h"
#include "ltm/store/segment_walk.h"

namespace engram::ltm {

namespace {

/// Max number of different kinds of damage reported for one entity in one segment.
constexpr size_t kMaxErrorsTold = 10;

/// Checks the entities of one open segment.
class SegmentCheck {
 public:
  SegmentCheck(SegmentReader& reader, const Manifest& manifest, const SegmentInfo& segment,
               const CheckOptions& options, const std::stop_token& stop, CheckReport& report,
               LinkCheck& links)
      : reader_(reader),
        manifest_(manifest),
        segment_(segment),
        options_(options),
        stop_(stop),
        report_(report),
        links_(links) {}

  Status run() {
    check_contents();
    auto types = reader_.types();
    if (!types.ok()) add("types of segments", types.status().message());
    types_ = std::move(types).value_or(SegmentTypes());
    for (const SegmentEntity& entity : segment_.entities) ENGRAM_RETURN_IF_ERROR(check(entity));
    return {};
  }

 private:
  void add(std::string object, std::string what) {
    report_.findings.push_back(fault(segment_.file, std::move(object), std::move(what)));
  }

  void check_contents() {
    const auto contents = reader_.contents();
    if (!contents.ok()) return add("", contents.status().message());
    for (const Status& damage : contents->damaged) add("", damage.message());
    if (contents->kind != segment_.kind) add("", "is of another kind than the manifest says");
    std::set<MemoryId> found(contents->entities.begin(), contents->entities.end());
    for (const SegmentEntity& entity : segment_.entities)
      if (found.erase(entity.id) == 0) add(entity.id.to_string(), "has no readable group");
    for (const MemoryId& entity : found)
      add(entity.to_string(), "is in the file, but not in the manifest");
  }

  Status check(const SegmentEntity& entity) {
    SegmentEntity seen;
    seen.id = entity.id;
    damaged_ = 0;
    damage_.clear();
    const Status walked =
        walk_rows(reader_, entity.id, [&](const RowSpan& span, const Status& times) -> Status {
          if (stop_.stop_requested()) return cancelled("check: stopped");
          note(seen, span, times.ok() ? check(seen, span) : times);
          return {};
        });
    if (walked.code() == StatusCode::kCancelled) return walked;
    if (!walked.ok()) add(entity.id.to_string(), walked.message());
    tell_damage(entity.id);
    // The counts of damaged data differ anyway; comparing them would report the same damage again.
    if (walked.ok() && damaged_ == 0) compare(entity, seen);
    if (segment_.kind == SegmentKind::kLatent) check_model(entity);
    return {};
  }

  /// Counts a snapshot and records why it cannot be read, if so.
  void note(SegmentEntity& seen, const RowSpan& span, const Status& status) {
    if (!status.ok()) add_damage(seen.id, span, status.message());
    if (seen.snapshots == 0) seen.first = span.time;
    seen.last = span.time;
    ++seen.snapshots;
    seen.rows += span.rows;
    ++report_.snapshots;
    report_.instances += span.rows;
  }

  /// Records damage. A damaged dataset affects every row, so equal messages are reported once.
  void add_damage(const MemoryId& entity, const RowSpan& span, const std::string& what) {
    ++damaged_;
    const auto known = std::ranges::find(damage_, what, &Damage::what);
    if (known != damage_.end())
      ++known->places;
    else if (damage_.size() < kMaxErrorsTold)
      damage_.push_back({span.time == Time{} ? entity : entity.at(span.time), what, 1});
  }

  void tell_damage(const MemoryId& entity) {
    uint64_t told = 0;
    for (const Damage& damage : damage_) {
      told += damage.places;
      add(damage.first.to_string(),
          damage.places == 1
              ? damage.what
              : fmt::format("{} (here and in {} more snapshots)", damage.what, damage.places - 1));
    }
    if (damaged_ > told)
      add(entity.to_string(), fmt::format("{} more snapshots are damaged", damaged_ - told));
  }

  Status check(SegmentEntity& seen, const RowSpan& span) {
    if (seen.snapshots > 0 && span.time < seen.last)
      return data_loss("row {} runs backwards in time", span.first);
    if (segment_.kind == SegmentKind::kLatent) return reader_.read_latent(seen.id, span).status();
    ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, reader_.read_recorded(seen.id, span));
    for (const PackedInstance& instance : packed.instances)
      report_.media += instance.value.media.size();
    seen.augmented += packed.is_augmented() ? 1 : 0;
    links_.add(packed, types_, segment_.file);
    return options_.is_deep ? unpack(packed, decoder_).status() : Status();
  }

  void compare(const SegmentEntity& told, const SegmentEntity& seen) {
    if (told.snapshots != seen.snapshots || told.rows != seen.rows)
      add(told.id.to_string(),
          fmt::format("has {} snapshots with {} instances, the manifest says {} with {}",
                      seen.snapshots, seen.rows, told.snapshots, told.rows));
    else if (told.first != seen.first || told.last != seen.last)
      add(told.id.to_string(),
          fmt::format("has snapshots from {} to {}, the manifest says from {} to {}",
                      to_string(seen.first), to_string(seen.last), to_string(told.first),
                      to_string(told.last)));
    else if (told.augmented != seen.augmented)
      add(told.id.to_string(), fmt::format("has {} augmented snapshots, the manifest says {}",
                                           seen.augmented, told.augmented));
  }

  void check_model(const SegmentEntity& entity) {
    const auto version = reader_.model_version(entity.id);
    if (!version.ok()) return add(entity.id.to_string(), version.status().message());
    if (*version != entity.latent.model_version)
      add(entity.id.to_string(), fmt::format("has latents of v{}, the manifest says v{}", *version,
                                             entity.latent.model_version));
    const bool is_there = std::ranges::any_of(manifest_.models, [&](const ModelInfo& model) {
      return model.entity == entity.id && model.version == *version;
    });
    if (!is_there)
      add(entity.id.to_string(), fmt::format("has latents of v{}, a model that is not there: "
                                             "nothing decodes them",
                                             *version));
  }

  SegmentReader& reader_;
  const Manifest& manifest_;
  const SegmentInfo& segment_;
  const CheckOptions& options_;
  const std::stop_token& stop_;
  CheckReport& report_;
  LinkCheck& links_;
  struct Damage {
    MemoryId first;
    std::string what;
    uint64_t places = 0;
  };

  SegmentTypes types_;
  MediumDecoder decoder_;
  std::vector<Damage> damage_;  ///< Damage of the current entity.
  uint64_t damaged_ = 0;        ///< Number of all damaged places of the current entity.
};

}  // namespace

Finding fault(std::string file, std::string object, std::string what) {
  return {Severity::kFault, std::move(file), std::move(object), std::move(what), kAdviceRecover};
}

std::vector<Finding> check_file(const std::filesystem::path& store, const std::string& file,
                                uint64_t bytes, uint64_t expected) {
  std::error_code error;
  const uint64_t found_bytes = std::filesystem::file_size(store / file, error);
  if (error) return {fault(file, "", "cannot be read: " + error.message())};
  if (found_bytes != bytes)
    return {fault(file, "", fmt::format("has {} bytes, the manifest says {}", found_bytes, bytes))};
  const auto found = checksum_of_file(store / file);
  if (!found.ok()) return {fault(file, "", found.status().message())};
  if (*found != expected) return {fault(file, "", "fails its checksum: bytes of it are damaged")};
  return {};
}

Status check_segment(const std::filesystem::path& store, const Manifest& manifest,
                     const SegmentInfo& segment, const CheckOptions& options,
                     const std::stop_token& stop, CheckReport& report, LinkCheck& links) {
  ++report.segments;
  report.bytes += segment.bytes;
  std::ranges::move(check_file(store, segment.file, segment.bytes, segment.checksum),
                    std::back_inserter(report.findings));
  const auto reader = SegmentReader::open(store / segment.file);
  if (!reader.ok()) {
    // check_file has already reported a missing file.
    if (reader.status().code() != StatusCode::kNotFound)
      report.findings.push_back(fault(segment.file, "", reader.status().message()));
    return {};
  }
  return SegmentCheck(**reader, manifest, segment, options, stop, report, links).run();
}

}  // namespace engram::ltm
