// SPDX-License-Identifier: Apache-2.0
#include "training/night/drop_raw.h"

#include <cmath>

#include "encoders/load_model.h"
#include "ltm/recall/recall.h"
#include "ltm/saliency/pending_saliency.h"
#include "training/fit/job_pace.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {

namespace {

bool is_within(const ltm::MeasuredError& error, const DropOptions& options) {
  const bool are_images_good =
      std::isnan(error.image_mse) || psnr_db(error.image_mse) >= options.min_psnr_db;
  const bool are_numbers_good =
      std::isnan(error.number_mse) || std::sqrt(error.number_mse) <= options.max_rmse;
  return are_images_good && are_numbers_good;
}

/// Whether every instance of the recalled snapshot is close enough to the recorded one.
Result<bool> may_go(const ltm::Snapshot& recorded, const ltm::SnapshotResult& recalled,
                    const DropOptions& options) {
  if (recorded.instances.size() != recalled.instances.size()) return false;
  for (size_t i = 0; i < recorded.instances.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MeasuredError found,
                            compare(recorded.instances[i].data, recalled.instances[i].data));
    const auto& published = recalled.instances[i].error;
    if (!published || !is_within(found, options) ||
        !is_as_told(found.image_mse, published->image_mse))
      return false;
  }
  return true;
}

}  // namespace

Result<ltm::DropReport> drop_raw(const std::filesystem::path& store, const ltm::MemoryId& entity,
                                 const DropOptions& options, const ProgressSink& progress,
                                 const std::stop_token& stop, JobPace* pace) {
  JobPace alone(nullptr, progress, stop);
  if (pace == nullptr) pace = &alone;
  ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(store));
  ltm::Recall recall(std::move(reader), encoders::load_model);
  ENGRAM_ASSIGN_OR_RETURN(const auto* entries, recall.store().index(entity));
  TimeSet keep;
  for (size_t i = 0; i < entries->size(); ++i) {
    const ltm::SnapshotEntry& entry = (*entries)[i];
    if (stop.stop_requested()) return cancelled("dropping raw data of '{}'", entity.to_string());
    if (!entry.recorded || !entry.latent) continue;
    ENGRAM_RETURN_IF_ERROR(pace->pause());
    if (options.stays_from && entry.time >= *options.stays_from) {
      keep.insert(entry.time);
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot recorded,
                            recall.store().read_recorded(entity, entry));
    const auto query = ltm::Query::of_entity(entity, ltm::select::At{entry.time});
    ENGRAM_ASSIGN_OR_RETURN(const auto result,
                            recall.query(query, {.prefer = ltm::Recall::Prefer::kLatent}));
    ENGRAM_ASSIGN_OR_RETURN(
        const bool may, may_go(recorded, result.entities().front()->snapshots.front(), options));
    if (!may) keep.insert(entry.time);
    pace->progress()({"verify " + entity.to_string(), i + 1, entries->size(), "", -1});
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto saliency, ltm::KeptSaliency::read(store));
  return saliency.carry_over(store, [&] { return ltm::drop_recorded(store, entity, keep); });
}

}  // namespace engram::training
