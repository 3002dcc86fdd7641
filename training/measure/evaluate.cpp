// SPDX-License-Identifier: Apache-2.0
#include "training/measure/evaluate.h"

#include <algorithm>
#include <cmath>

#include "encoders/load_model.h"
#include "encoders/model_file.h"
#include "ltm/memory/query.h"
#include "ltm/prediction/value_row.h"
#include "ltm/store/store_reader.h"
#include "training/fit/condition_source.h"
#include "training/fit/matching.h"
#include "ltm/core/sequences.h"
#include "training/measure/access_time.h"
#include "training/measure/code_length.h"
#include "training/measure/quality_sums.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {

namespace {

constexpr int kHorizons = 2;
bool contains(const std::vector<encoders::TimeSpan>& spans, Time first, Time last) {
  return std::any_of(spans.begin(), spans.end(), [&](const encoders::TimeSpan& span) {
    return span.contains(first) && span.contains(last);
  });
}

Known known_of(const encoders::Provenance& from, Time first, Time last) {
  if (contains(from.dynamics_spans, first, last)) return Known::kTrained;
  if (contains(from.autoencoder_spans, first, last)) return Known::kHeldOut;
  return Known::kLeftOutRecording;
}

/// Measures the newest model of one entity.
class EntityMeasurement {
 public:
  EntityMeasurement(ltm::StoreReader& reader, const ltm::ModelInfo& model,
                    const EvaluateOptions& options, const ProgressSink& progress,
                    const std::stop_token& stop)
      : reader_(reader), info_(model), options_(options), progress_(progress), stop_(stop) {}

  Result<EntityEvaluation> run() {
    const auto path = reader_.path() / info_.file;
    ENGRAM_ASSIGN_OR_RETURN(model_, encoders::load_model(path));
    ENGRAM_ASSIGN_OR_RETURN(provenance_, encoders::read_provenance(path));
    ENGRAM_ASSIGN_OR_RETURN(index_, reader_.index(info_.entity));
    result_.entity = info_.entity;
    result_.model_version = info_.version;
    ENGRAM_RETURN_IF_ERROR(measure_reconstruction());
    ENGRAM_ASSIGN_OR_RETURN(result_.access,
                            measure_access(reader_, info_, *index_, *model_.encoder));
    ENGRAM_ASSIGN_OR_RETURN(result_.code, measure_code_length(reader_, info_, *index_));
    ENGRAM_RETURN_IF_ERROR(measure_predictions());
    ENGRAM_RETURN_IF_ERROR(add_bytes());
    return std::move(result_);
  }

 private:
  Status step(std::string_view what, size_t done, size_t total) {
    if (stop_.stop_requested()) return cancelled("evaluation was stopped");
    if (progress_)
      progress_({fmt::format("{} {}", what, info_.entity.to_string()), done, total, {}, -1});
    return {};
  }

  Status measure_reconstruction() {
    QualitySums trained, left_out;
    for (size_t i = 0; i < index_->size(); ++i) {
      ENGRAM_RETURN_IF_ERROR(step("reconstruct", i, index_->size()));
      const ltm::SnapshotEntry& entry = (*index_)[i];
      if (!entry.latent) continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto latent, reader_.read_latent(info_.entity, entry));
      if (latent.model_version != info_.version) continue;
      ++result_.snapshots;
      if (!entry.recorded) {
        ++result_.not_evaluated;
        continue;
      }
      const bool is_left_out =
          known_of(provenance_, entry.time, entry.time) == Known::kLeftOutRecording;
      ENGRAM_RETURN_IF_ERROR(compare_one(entry, latent, is_left_out ? left_out : trained));
    }
    result_.reconstruction = trained.quality();
    result_.left_out_reconstruction = left_out.quality();
    return {};
  }

  Status compare_one(const ltm::SnapshotEntry& entry, const ltm::LatentSnapshot& latent,
                     QualitySums& sums) {
    ENGRAM_ASSIGN_OR_RETURN(const auto recorded, reader_.read_recorded(info_.entity, entry));
    if (recorded.instances.size() != latent.instances.size())
      return data_loss("'{}': found {} latents for {} instances",
                       info_.entity.at(entry.time).to_string(), latent.instances.size(),
                       recorded.instances.size());
    for (size_t i = 0; i < recorded.instances.size(); ++i) {
      ENGRAM_ASSIGN_OR_RETURN(const auto values,
                              model_.encoder->decode({&latent.instances[i].latent, 1}));
      ENGRAM_ASSIGN_OR_RETURN(const auto error,
                              compare(recorded.instances[i].data, values.front()));
      sums.add(error);
    }
    return {};
  }

  Status measure_predictions() {
    std::vector<const ltm::SnapshotEntry*> recorded;
    std::vector<Time> times;
    for (const ltm::SnapshotEntry& entry : *index_) {
      if (!entry.recorded) continue;
      recorded.push_back(&entry);
      times.push_back(entry.time);
    }
    std::vector<size_t> rows;  // Rows of the last snapshot before a prediction.
    for (const Sequence& sequence : cut_sequences(times))
      for (size_t row = sequence.first + 1; row + 1 < sequence.end; ++row) rows.push_back(row);
    const size_t stride =
        std::max<size_t>(1, rows.size() / std::max<size_t>(options_.max_predictions, 1));
    // The same gap as in cut_sequences: predictions never cross it.
    const Duration longest = median_step(times) / 2 * 3;
    for (size_t i = 0; i < rows.size(); i += stride) {
      ENGRAM_RETURN_IF_ERROR(step("predict", i, rows.size()));
      ENGRAM_RETURN_IF_ERROR(predict_from(recorded, rows[i], longest));
    }
    for (size_t kind = 0; kind < kKnownKinds; ++kind)
      for (size_t h = 0; h < kHorizons; ++h)
        result_.prediction[kind].push_back(
            {static_cast<int>(h + 1), predicted_[kind][h].quality.quality(),
             copied_[kind][h].quality.quality(), predicted_[kind][h].bound_coverage(),
             copied_[kind][h].bound_coverage()});
    return {};
  }

  Status predict_from(const std::vector<const ltm::SnapshotEntry*>& recorded, size_t row,
                      Duration longest) {
    std::vector<idf::Data> values;
    const size_t last = std::min(row + kHorizons, recorded.size() - 1);
    for (size_t i = row - 1; i <= last; ++i) {
      if (i > row && recorded[i]->time - recorded[i - 1]->time > longest) break;
      ENGRAM_ASSIGN_OR_RETURN(auto snapshot, reader_.read_recorded(info_.entity, *recorded[i]));
      if (snapshot.instances.empty()) return {};
      values.push_back(std::move(snapshot.instances.front().data));
    }
    const auto history = std::span(values).first(2);
    const auto truth = std::span(values).subspan(2);
    const std::array<Time, 2> times{recorded[row - 1]->time, recorded[row]->time};
    ENGRAM_ASSIGN_OR_RETURN(const auto conditions,
                            conditions_at(reader_, model_.predictor->condition(), times));
    const auto steps = static_cast<int>(truth.size());
    const auto futures = model_.predictor->predict({history, conditions}, steps);
    // Snapshots of another layout cannot be predicted by this model and are skipped.
    if (!futures.ok() && futures.status().code() == StatusCode::kInvalidArgument) return {};
    if (!futures.ok()) return futures.status();
    ENGRAM_ASSIGN_OR_RETURN(const auto copies, model_.copy_last->predict({history, {}}, steps));
    const auto uncounted =
        ltm::ValueRow(history.back(), reader_.manifest().types.of_entity(info_.entity))
            .uncounted_paths();
    for (size_t h = 0; h < truth.size(); ++h) {
      const auto error = compare_prediction(truth[h], (*futures)[h].value, uncounted);
      const auto copy_error = compare_prediction(truth[h], copies[h].value, uncounted);
      if (!error.ok() || !copy_error.ok()) return {};
      const auto kind = static_cast<size_t>(
          known_of(provenance_, recorded[row - 1]->time, recorded[row + h + 1]->time));
      predicted_[kind][h].add((*futures)[h].error, *error);
      copied_[kind][h].add(copies[h].error, *copy_error);
    }
    return {};
  }

  Status add_bytes() {
    ENGRAM_ASSIGN_OR_RETURN(const auto summary, reader_.summary(info_.entity));
    result_.raw_bytes = summary.raw_bytes;
    result_.stored_bytes = summary.stored_bytes;
    result_.latent_bytes = summary.latent_bytes;
    result_.model_bytes = summary.model_bytes;
    return {};
  }

  ltm::StoreReader& reader_;
  const ltm::ModelInfo& info_;
  const EvaluateOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  ltm::LoadedModel model_;
  encoders::Provenance provenance_;
  const std::vector<ltm::SnapshotEntry>* index_ = nullptr;
  std::array<std::array<PredictionSums, kHorizons>, kKnownKinds> predicted_;
  std::array<std::array<PredictionSums, kHorizons>, kKnownKinds> copied_;
  EntityEvaluation result_;
};

/// The newest model of every entity that the queries match.
Result<std::vector<const ltm::ModelInfo*>> newest_models(const ltm::StoreReader& reader,
                                                         const std::vector<std::string>& texts) {
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, matching_entities(reader, texts));
  std::vector<const ltm::ModelInfo*> models;
  for (const ltm::MemoryId& entity : entities)
    if (const auto* newest = reader.manifest().newest_model(entity)) models.push_back(newest);
  return models;
}

}  // namespace

Result<EvalReport> evaluate(const std::filesystem::path& store, const EvaluateOptions& options,
                            const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
  ENGRAM_ASSIGN_OR_RETURN(const auto models, newest_models(*reader, options.entities));
  EvalReport report;
  for (const ltm::ModelInfo* model : models) {
    ENGRAM_ASSIGN_OR_RETURN(EntityEvaluation one,
                            EntityMeasurement(*reader, *model, options, progress, stop).run());
    report.entities.push_back(std::move(one));
  }
  return report;
}

}  // namespace engram::training
