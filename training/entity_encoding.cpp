// SPDX-License-Identifier: Apache-2.0
#include "training/entity_encoding.h"

#include <algorithm>

#include "ltm/idf/binary.h"
#include "training/sequences.h"

namespace engram::training {

Status EntityEncoding::run(std::span<const ltm::SnapshotEntry> entries, JobPace& pace) {
  std::vector<Time> times;
  for (const ltm::SnapshotEntry& entry : entries) times.push_back(entry.time);
  for (const Sequence& sequence : cut_sequences(times))
    for (size_t first = sequence.first; first < sequence.end; first += most_rows_) {
      const size_t count = std::min(most_rows_, sequence.end - first);
      begun_ = first;
      total_ = entries.size();
      ENGRAM_RETURN_IF_ERROR(encode_run(entries.subspan(first, count), pace));
      tell(first + count, pace);
    }
  return {};
}

Status EntityEncoding::encode_run(std::span<const ltm::SnapshotEntry> entries, JobPace& pace) {
  std::vector<idf::Data> values;
  std::vector<ltm::Snapshot> snapshots;
  for (const ltm::SnapshotEntry& entry : entries) {
    ENGRAM_ASSIGN_OR_RETURN(snapshots.emplace_back(), reader_.read_recorded(entity_, entry));
    for (const ltm::Instance& instance : snapshots.back().instances)
      values.push_back(instance.data);
  }
  ENGRAM_ASSIGN_OR_RETURN(auto latents, encode_blocks(values, pace));
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

void EntityEncoding::tell(size_t done, JobPace& pace) const {
  pace.progress()({"encode " + entity_.to_string(), std::min(done, total_), total_, {}, -1});
}

/// Snapshots of several instances fill more than one block.
Result<std::vector<ltm::Latent>> EntityEncoding::encode_blocks(std::span<const idf::Data> values,
                                                               JobPace& pace) {
  const auto pause = [&] {
    tell(begun_, pace);
    begun_ += chain_rows_;
    return pace.pause();
  };
  std::vector<ltm::Latent> latents;
  while (!values.empty()) {
    const auto block = values.first(std::min(most_rows_, values.size()));
    values = values.subspan(block.size());
    ENGRAM_ASSIGN_OR_RETURN(auto coded, choice_.encode(block, pace.stop(), pause));
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

void EntityEncoding::report(EntityReport& report) const {
  report.snapshots = latents_.size();
  report.raw_bytes = raw_bytes_;
  report.latent_bytes = latent_bytes_;
  report.mean_psnr_db = psnr_.mean_db();
  report.pooled_psnr_db = psnr_.pooled_db();
  report.minimum_psnr_db = psnr_.minimum_db();
  report.psnr_quantiles_db = {psnr_.quantile_db(0.05), psnr_.quantile_db(0.5),
                              psnr_.quantile_db(0.95)};
  report.rmse = rmse_.rmse();
  report.forms = choice_.counts();
}

}  // namespace engram::training
