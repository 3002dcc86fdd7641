// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/sealed_indexer.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "ltm/context/segment_contexts.h"
#include "ltm/core/log.h"
#include "ltm/likeness/seen_image.h"
#include "ltm/likeness/stored_codes.h"
#include "ltm/recall/store_past.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

/// Segments that may wait: hours of recording.
constexpr size_t kMaxWaiting = 256;
/// A quarter of the time is worked. HDF5 has one lock, so a thread that got hardly any time would
/// hold it for long: its priority is lower, and not the lowest.
constexpr int kRestsPerWork = 3;
constexpr int kNice = 10;

/// The files of all spaces of a store, relative to it. A segment may have a hundred thousand
/// entities, of which few have one.
std::set<std::string> spaces_of(const std::filesystem::path& store) {
  std::set<std::string> files;
  std::error_code error;
  std::filesystem::directory_iterator file(store / kIndexFolder, error);
  for (; !error && file != std::filesystem::directory_iterator(); file.increment(error))
    if (file->path().extension() == std::string(".") + kSpaceIndex)
      files.insert(std::string(kIndexFolder) + "/" + file->path().filename().string());
  return files;
}

/// Adds codes to the index of a segment. Of entities that a night was quicker with, its codes stay.
Status add_codes(const StoreReader& store, const SegmentInfo& segment, SegmentCodes codes) {
  if (codes.empty()) return {};
  const Status stored = edit_segment_index(
      store.path(), segment, kCodesIndex, [&codes](std::span<const std::byte> there) {
        SegmentCodes all;
        if (auto known = unpack_codes(there); known.ok()) all = *std::move(known);
        for (EntityCodes& one : codes)
          if (std::ranges::find(all, one.entity, &EntityCodes::entity) == all.end())
            all.push_back(std::move(one));
        return pack_codes(all);
      });
  // It was replaced meanwhile, and the next night codes what replaced it.
  return stored.code() == StatusCode::kNotFound ? Status() : stored;
}

}  // namespace

SealedIndexer::SealedIndexer(std::filesystem::path store)
    : store_(std::move(store)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

SealedIndexer::~SealedIndexer() = default;

void SealedIndexer::add(const std::string& segment_file) {
  const MutexLock lock(mutex_);
  if (waiting_.size() >= kMaxWaiting) {
    ++left_;
    return;
  }
  waiting_.push_back(segment_file);
  changed_.notify_all();
}

void SealedIndexer::finish(const std::stop_token& stop) {
  const MutexLock lock(mutex_);
  is_hurried_ = true;
  changed_.notify_all();
  changed_.wait(mutex_, stop,
                [this]() ENGRAM_REQUIRES(mutex_) { return waiting_.empty() && !is_coding_; });
  is_hurried_ = false;
}

void SealedIndexer::run(const std::stop_token& stop) {
  // Of this thread alone. Without it the codes are made all the same.
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice);
  MutexLock lock(mutex_);
  while (changed_.wait(mutex_, stop, [this]() ENGRAM_REQUIRES(mutex_) {
    return !waiting_.empty();
  }) && !stop.stop_requested()) {
    const std::string file = std::move(waiting_.front());
    waiting_.pop_front();
    is_coding_ = true;
    lock.unlock();
    const Status coded = code(file, stop);
    if (!coded.ok()) {
      ++left_;
      if (coded.code() != StatusCode::kCancelled)
        log::warning("store '{}': '{}' has no indexes until the next night: {}", store_.string(),
                     file, coded.message());
    }
    lock.lock();
    is_coding_ = false;
    changed_.notify_all();
  }
}

Status SealedIndexer::code(const std::string& segment_file, const std::stop_token& stop) {
  SteadyTime began = steady_now();
  ENGRAM_ASSIGN_OR_RETURN(const auto past, StorePast::open(store_, {}, {}));
  StoreReader& store = past->store();
  const auto& segments = store.manifest().segments;
  const auto segment = std::ranges::find(segments, segment_file, &SegmentInfo::file);
  if (segment == segments.end()) return {};
  const auto number = static_cast<uint32_t>(segment - segments.begin());
  // What was just sealed has no latents.
  ENGRAM_RETURN_IF_ERROR(index_segment(store, number, {}, stop).status());
  rest(steady_now() - began, stop);
  const auto spaces = spaces_of(store_);
  if (spaces.empty()) return {};
  SegmentCodes made;
  for (const SegmentEntity& part : segment->entities) {
    if (!spaces.contains(entity_index_name(part.id, kSpaceIndex))) continue;
    const auto space = read_space(store, part.id);
    if (!space) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto images, past->of(part.id));
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store.timeline(part.id));
    EntityCodes codes{part.id, space->id(), {}, {}};
    ENGRAM_RETURN_IF_ERROR(
        timeline->for_each(part.first, part.last, [&](const SnapshotEntry& entry) -> Status {
          if (segment_of_code(entry) != number) return {};
          if (stop.stop_requested()) return cancelled("coding '{}'", segment_file);
          const SteadyTime start = steady_now();
          ENGRAM_ASSIGN_OR_RETURN(const auto seen, see(*images, entry.time));
          if (seen && seen->size == space->size) {
            codes.append(entry.time, space->code(seen->descriptor));
            ++coded_;
          }
          rest(steady_now() - start, stop);
          return {};
        }));
    if (!codes.times.empty()) made.push_back(std::move(codes));
  }
  began = steady_now();
  // All at once: each edit reads and writes the whole file under the lock that sealing takes, too.
  ENGRAM_RETURN_IF_ERROR(add_codes(store, *segment, std::move(made)));
  rest(steady_now() - began, stop);
  return {};
}

void SealedIndexer::rest(Duration worked, const std::stop_token& stop) {
  const MutexLock lock(mutex_);
  changed_.wait_for(mutex_, stop, kRestsPerWork * worked,
                    [this]() ENGRAM_REQUIRES(mutex_) { return is_hurried_; });
}

}  // namespace engram::ltm
