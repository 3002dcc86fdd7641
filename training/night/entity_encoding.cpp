// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_encoding.h"

#include <algorithm>

#include "ltm/idf/binary.h"
#include "training/fit/sequences.h"
#include "training/night/stored_videos.h"

namespace engram::training {

Status EntityEncoding::run(std::span<const ltm::SnapshotEntry> entries, JobPace& pace) {
  const auto tell = [&](size_t done) {
    pace.progress()({"encode " + entity_.to_string(), done, entries.size(), {}, -1});
  };
  std::vector<Time> times;
  for (const ltm::SnapshotEntry& entry : entries) times.push_back(entry.time);
  for (const Sequence& sequence : cut_recordings(times))
    for (size_t first = sequence.first; first < sequence.end; first += max_rows_) {
      const size_t count = std::min(max_rows_, sequence.end - first);
      // With several instances there are more rows than snapshots.
      const auto pause = [&](size_t rows) {
        tell(first + std::min(rows, count));
        return pace.pause();
      };
      ENGRAM_RETURN_IF_ERROR(encode_run(entries.subspan(first, count), pace.stop(), pause));
      tell(first + count);
    }
  return {};
}

Status EntityEncoding::encode_run(std::span<const ltm::SnapshotEntry> entries,
                                  const std::stop_token& stop, const BlockChoice::Pause& pause) {
  std::vector<idf::Data> values;
  std::vector<ltm::Snapshot> snapshots;
  {
    const StageTimes::Scope reading(&times_, Stage::kReading);
    for (const ltm::SnapshotEntry& entry : entries) {
      ENGRAM_ASSIGN_OR_RETURN(snapshots.emplace_back(), reader_.read_recorded(entity_, entry));
      for (const ltm::Instance& instance : snapshots.back().instances)
        values.push_back(instance.data);
    }
    add_stored_videos(reader_, entity_, entries, values, model_, choice_.videos());
  }
  ENGRAM_ASSIGN_OR_RETURN(auto latents, encode_blocks(values, stop, pause));
  const StageTimes::Scope verification(&times_, Stage::kVerification);
  ENGRAM_ASSIGN_OR_RETURN(const auto decoded, decoder_.decode(latents));
  size_t at = 0;
  for (const ltm::Snapshot& snapshot : snapshots) {
    ltm::LatentSnapshot coded{snapshot.time, version_, {}};
    for (const ltm::Instance& instance : snapshot.instances) {
      ENGRAM_ASSIGN_OR_RETURN(const auto error, compare(instance.data, decoded[at]));
      count(latents[at], error);
      coded.instances.push_back({std::move(latents[at++]), instance.metadata, error});
    }
    raw_bytes_ += snapshot.raw_bytes();
    latents_.push_back(std::move(coded));
  }
  return {};
}

/// Snapshots with several instances fill more than one block.
Result<std::vector<ltm::Latent>> EntityEncoding::encode_blocks(std::span<const idf::Data> values,
                                                               const std::stop_token& stop,
                                                               const BlockChoice::Pause& pause) {
  std::vector<ltm::Latent> latents;
  while (latents.size() < values.size()) {
    const size_t first = latents.size();
    const auto rest = values.subspan(first);
    const auto on_row = [&](size_t row) { return pause(first + row); };
    ENGRAM_ASSIGN_OR_RETURN(
        auto coded, choice_.encode(rest.first(std::min(max_rows_, rest.size())), stop, on_row));
    std::ranges::move(coded, std::back_inserter(latents));
  }
  return latents;
}

void EntityEncoding::count(const ltm::Latent& latent, const ltm::MeasuredError& error) {
  psnr_.add(error.image_mse);
  rmse_.add(error.number_mse);
  if (latent.place.index == 0) latent_bytes_ += latent.code.size();
  if (!latent.remainder.empty()) latent_bytes_ += idf::encoded_size(idf::Data(latent.remainder));
}

KeptQuality EntityEncoding::quality() const {
  KeptQuality quality;
  quality.snapshots = latents_.size();
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
