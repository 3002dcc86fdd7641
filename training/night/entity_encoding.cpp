// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_encoding.h"

#include <algorithm>
#include <chrono>

#include "ltm/idf/binary.h"
#include "ltm/core/sequences.h"
#include "training/night/stored_videos.h"

namespace engram::training {

/// The values of consecutive snapshots of one recording.
struct EntityEncoding::Run {
  std::span<const ltm::SnapshotEntry> entries;
  std::vector<ltm::Snapshot> snapshots;
  std::vector<idf::Data> values;  ///< Of all instances.

  /// Snapshots with several instances fill more than one block.
  [[nodiscard]] std::vector<std::span<const idf::Data>> blocks(size_t max_rows) const {
    std::vector<std::span<const idf::Data>> blocks;
    for (auto rest = std::span(values); !rest.empty(); rest = rest.subspan(blocks.back().size()))
      blocks.push_back(rest.first(std::min(max_rows, rest.size())));
    return blocks;
  }
};

namespace {

/// Rows of which videos are found together: enough chains for several cores.
constexpr size_t kChainsAhead = 8;

}  // namespace

Status EntityEncoding::run(std::span<const ltm::SnapshotEntry> entries, JobPace& pace,
                           const EncodingLimits& limits) {
  EncodingRate rate(limits, pace);
  size_t told = 0;
  const auto tell = [&](size_t done) {
    told = std::max(told, done);
    pace.progress()({"encode " + entity_.to_string(),
                     told,
                     entries.size(),
                     {},
                     rate.seconds_for(entries.size() - told)});
  };
  Time published = pace.now();
  for (Parts parts = parts_of(entries); !parts.empty();) {
    const size_t fitting = rate.fitting(model_.codec.chain_rows);
    if (fitting == 0) return {};
    const auto start = std::chrono::steady_clock::now();
    const double paused = pace.paused_seconds();
    const size_t first = done_;
    ENGRAM_ASSIGN_OR_RETURN(const std::vector<Run> runs, read_next(parts, fitting));
    size_t snapshots = 0;
    for (const Run& run : runs) snapshots += run.entries.size();
    bool is_late = false;
    // With several instances there are more rows than snapshots.
    const auto pause = [&](size_t rows) -> Status {
      tell(first + std::min(rows, snapshots));
      is_late = rate.is_over();
      return is_late ? resource_exhausted("the time to encode is over") : pace.pause();
    };
    const Status encoded = encode(runs, pace.stop(), pause);
    if (!encoded.ok() && (is_late || pace.is_time_over())) return {};
    ENGRAM_RETURN_IF_ERROR(encoded);
    rate.count(snapshots, to_seconds(std::chrono::steady_clock::now() - start) -
                              (pace.paused_seconds() - paused));
    tell(done_);
    if (!limits.publish || parts.empty() || pace.now() - published < limits.publish_interval)
      continue;
    ENGRAM_RETURN_IF_ERROR(limits.publish(latents_, quality()));
    latents_.clear();
    published = pace.now();
  }
  return {};
}

EntityEncoding::Parts EntityEncoding::parts_of(std::span<const ltm::SnapshotEntry> entries) const {
  std::vector<Time> times;
  for (const ltm::SnapshotEntry& entry : entries) times.push_back(entry.time);
  Parts parts;
  for (const Sequence& sequence : cut_recordings(times))
    for (size_t first = sequence.first; first < sequence.end; first += max_rows_)
      parts.push_back(entries.subspan(first, std::min(max_rows_, sequence.end - first)));
  return parts;
}

Result<std::vector<EntityEncoding::Run>> EntityEncoding::read_next(Parts& parts,
                                                                   size_t max_snapshots) {
  const size_t rows_ahead = kChainsAhead * model_.codec.chain_rows;
  std::vector<Run> runs;
  size_t rows = 0;
  do {
    auto& part = parts.front();
    const size_t count = std::min(part.size(), max_snapshots);
    ENGRAM_ASSIGN_OR_RETURN(runs.emplace_back(), read(part.first(count)));
    rows += runs.back().values.size();
    max_snapshots -= count;
    part = part.subspan(count);
    if (part.empty()) parts.pop_front();
  } while (rows < rows_ahead && max_snapshots > 0 && !parts.empty() && choice_.finds_videos());
  return runs;
}

Result<EntityEncoding::Run> EntityEncoding::read(std::span<const ltm::SnapshotEntry> entries) {
  const StageTimes::Scope reading(&times_, Stage::kReading);
  Run run{entries, {}, {}};
  for (const ltm::SnapshotEntry& entry : entries) {
    ENGRAM_ASSIGN_OR_RETURN(run.snapshots.emplace_back(), reader_.read_recorded(entity_, entry));
    for (const ltm::Instance& instance : run.snapshots.back().instances)
      run.values.push_back(instance.data);
  }
  add_stored_videos(reader_, entity_, entries, run.values, model_, choice_.videos());
  return run;
}

Status EntityEncoding::encode(std::span<const Run> runs, const std::stop_token& stop,
                              const BlockChoice::Pause& pause) {
  // What one run has is found when it is encoded.
  if (runs.size() > 1) {
    std::vector<std::span<const idf::Data>> blocks;
    for (const Run& run : runs)
      std::ranges::copy(run.blocks(max_rows_), std::back_inserter(blocks));
    ENGRAM_RETURN_IF_ERROR(choice_.find_ahead(blocks, stop, pause));
  }
  size_t rows = 0;
  for (const Run& run : runs) {
    std::vector<ltm::Latent> latents;
    for (const auto& block : run.blocks(max_rows_)) {
      const auto on_row = [&](size_t row) { return pause(rows + row); };
      ENGRAM_ASSIGN_OR_RETURN(auto coded, choice_.encode(block, stop, on_row));
      std::ranges::move(coded, std::back_inserter(latents));
      rows += block.size();
    }
    ENGRAM_RETURN_IF_ERROR(keep(run, std::move(latents)));
  }
  return {};
}

Status EntityEncoding::keep(const Run& run, std::vector<ltm::Latent> latents) {
  const StageTimes::Scope verification(&times_, Stage::kVerification);
  ENGRAM_ASSIGN_OR_RETURN(const auto decoded, decoder_.decode(latents));
  size_t at = 0;
  for (const ltm::Snapshot& snapshot : run.snapshots) {
    ltm::LatentSnapshot coded{snapshot.time, version_, {}};
    for (const ltm::Instance& instance : snapshot.instances) {
      ENGRAM_ASSIGN_OR_RETURN(const auto error, compare(instance.data, decoded[at]));
      count(latents[at], error);
      coded.instances.push_back({std::move(latents[at++]), instance.metadata, error});
    }
    raw_bytes_ += snapshot.raw_bytes();
    latents_.push_back(std::move(coded));
    ++done_;
  }
  return {};
}

void EntityEncoding::count(const ltm::Latent& latent, const ltm::MeasuredError& error) {
  psnr_.add(error.image_mse);
  rmse_.add(error.number_mse);
  if (latent.place.index == 0) latent_bytes_ += latent.code.size();
  if (!latent.remainder.empty()) latent_bytes_ += idf::encoded_size(idf::Data(latent.remainder));
}

KeptQuality EntityEncoding::quality() const {
  KeptQuality quality;
  quality.snapshots = done_;
  quality.raw_bytes = raw_bytes_;
  quality.latent_bytes = latent_bytes_;
  quality.mean_psnr_db = psnr_.mean_db();
  quality.pooled_psnr_db = psnr_.pooled_db();
  quality.minimum_psnr_db = psnr_.minimum_db();
  quality.psnr_quantiles_db = {psnr_.quantile_db(0.05), psnr_.quantile_db(0.5),
                               psnr_.quantile_db(0.95)};
  quality.rmse = rmse_.rmse();
  quality.forms = choice_.counts();
  return quality;
}

}  // namespace engram::training
