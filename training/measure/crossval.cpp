// SPDX-License-Identifier: Apache-2.0
#include "training/measure/crossval.h"

#include <algorithm>

#include "encoders/deep_model_file.h"
#include "ltm/prediction/value_row.h"
#include "ltm/store/temporary_file.h"
#include "training/fit/augmented_source.h"
#include "training/fit/condition_source.h"
#include "training/fit/entity_source.h"
#include "training/fit/matching.h"
#include "training/fit/trainer.h"
#include "training/forms/block_choice.h"
#include "training/measure/crossval_sums.h"

namespace engram::training {

namespace {

/// Trains and measures folds of one entity.
class Crossval {
 public:
  Crossval(ltm::StoreReader& reader, const ltm::MemoryId& entity, const CrossvalOptions& options,
           const ProgressSink& progress, const std::stop_token& stop, const FoldSink& on_fold)
      : reader_(reader),
        entity_(entity),
        options_(options),
        progress_(progress),
        stop_(stop),
        on_fold_(on_fold) {}

  Result<CrossvalReport> run() {
    ENGRAM_ASSIGN_OR_RETURN(EntitySource found,
                            EntitySource::find(reader_, entity_, 2, false, stop_));
    if (!found.missing.empty())
      return invalid_argument("{}: {}", entity_.to_string(), found.missing);
    const std::vector<Sequence> recordings = take(std::move(found.entries));
    if (recordings.size() < 2)
      return invalid_argument("{}: found {} recording, needs two to leave one out",
                              entity_.to_string(), recordings.size());
    ENGRAM_ASSIGN_OR_RETURN(plan_, encoders::TensorPlan::create(std::move(found.layout)));
    CrossvalReport report;
    report.entity = entity_;
    report.bound_db = options_.bound_db;
    ENGRAM_ASSIGN_OR_RETURN(const auto folds, folds_of(recordings.size()));
    FoldSums all(options_.variants.size(), options_.max_horizon);
    for (const size_t number : folds) {
      ENGRAM_ASSIGN_OR_RETURN(const FoldSums sums, run_fold(recordings, number - 1));
      all.add(sums, folds.size());
      report.folds.push_back(sums.fold(options_.variants));
      report.folds.back().first = entries_[recordings[number - 1].first].time;
      if (on_fold_) on_fold_(report.folds.back(), number);
    }
    report.all = all.fold(options_.variants);
    return report;
  }

 private:
  /// Numbers of the recordings to leave out.
  Result<std::vector<size_t>> folds_of(size_t recordings) const {
    std::vector<size_t> folds = options_.folds;
    if (folds.empty())
      for (size_t number = 1; number <= recordings; ++number) folds.push_back(number);
    for (const size_t number : folds)
      if (number > recordings)
        return invalid_argument("{}: found fold {}, it has {} recordings", entity_.to_string(),
                                number, recordings);
    return folds;
  }

  /// Divides the recorded snapshots into measured ones and those in between, and returns the
  /// recordings of the measured ones.
  std::vector<Sequence> take(std::vector<ltm::SnapshotEntry> entries) {
    std::vector<Time> times;
    for (const ltm::SnapshotEntry& entry : entries) times.push_back(entry.time);
    std::vector<Sequence> recordings = cut_sequences(times);
    between_.resize(recordings.size());
    if (options_.spacing == Duration::zero()) {
      entries_ = std::move(entries);
      return recordings;
    }
    for (size_t i = 0; i < recordings.size(); ++i) {
      const auto runs = interleaved(times, recordings[i], options_.spacing);
      recordings[i].first = entries_.size();
      for (const size_t index : runs.front()) entries_.push_back(entries[index]);
      recordings[i].end = entries_.size();
      for (const auto& run : std::span(runs).subspan(1))
        for (const size_t index : run) between_[i].push_back(entries[index]);
    }
    return recordings;
  }

  Result<FoldSums> run_fold(const std::vector<Sequence>& recordings, size_t fold) {
    FoldSums sums(options_.variants.size(), options_.max_horizon);
    sums.snapshots = recordings[fold].size();
    ENGRAM_RETURN_IF_ERROR(measure_baselines(recordings[fold], sums));
    for (size_t i = 0; i < options_.variants.size(); ++i)
      ENGRAM_RETURN_IF_ERROR(
          measure_variant(recordings, fold, options_.variants[i], sums.variants[i]));
    return sums;
  }

  Status measure_baselines(const Sequence& recording, FoldSums& sums) {
    for (size_t way = 0; way < kBaselines; ++way)
      ENGRAM_RETURN_IF_ERROR(measure_predictions(
          recording, std::nullopt,
          [&](const ltm::Past& past, int steps) {
            return without_estimates(predict_by(static_cast<Baseline>(way), plan_, past.values[0],
                                                past.values[1], steps));
          },
          sums.baselines[way]));
    return {};
  }

  Status measure_variant(const std::vector<Sequence>& recordings, size_t fold,
                         encoders::TrainingVariant variant, VariantSums& sums) {
    ENGRAM_ASSIGN_OR_RETURN(const auto file,
                            ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
    ENGRAM_RETURN_IF_ERROR(train(recordings, fold, variant, file.path()));
    // The model is read back from its file, so that the stored one is measured.
    ENGRAM_ASSIGN_OR_RETURN(const auto model, encoders::read_model(file.path()));
    std::vector<std::vector<float>> codes;
    ENGRAM_RETURN_IF_ERROR(reconstruct_all(*model, recordings, fold, options_.representation(false),
                                           sums.latents, &codes));
    if (options_.bound_db > 0)
      ENGRAM_RETURN_IF_ERROR(reconstruct_all(
          *model, recordings, fold, options_.representation(true), sums.corrected, nullptr));
    const Sequence& left_out = recordings[fold];
    const auto predictor = encoders::make_predictor(model);
    const auto predict = [&](ltm::Past past, int steps) {
      // The plan is removed, because it holds the real future of the condition.
      past.plan = {};
      return predictor->predict(past, steps);
    };
    const auto follow = [&](const ltm::Past& past, int steps) {
      return predictor->predict(past, steps);
    };
    const auto condition = predictor->condition();
    ENGRAM_RETURN_IF_ERROR(measure_predictions(left_out, condition, predict, sums.prediction));
    if (condition)
      ENGRAM_RETURN_IF_ERROR(measure_predictions(left_out, condition, follow, sums.planned));
    ENGRAM_ASSIGN_OR_RETURN(sums.similarity,
                            measure_similarity(
                                codes, left_out, [&](size_t i) { return value_at(i); }, stop_));
    std::error_code failed;
    sums.model_bytes = static_cast<double>(std::filesystem::file_size(file.path(), failed));
    if (failed) return unavailable("model '{}': {}", file.path().string(), failed.message());
    return {};
  }

  Status train(const std::vector<Sequence>& recordings, size_t fold,
               encoders::TrainingVariant variant, const std::filesystem::path& file) {
    std::vector<ltm::SnapshotEntry> trained;
    for (size_t i = 0; i < recordings.size(); ++i) {
      // Snapshots between the measured ones of the left-out recording are left out too: they are
      // nearly the same images.
      if (i == fold) continue;
      const auto measured = std::span(entries_).subspan(recordings[i].first, recordings[i].size());
      trained.insert(trained.end(), measured.begin(), measured.end());
      trained.insert(trained.end(), between_[i].begin(), between_[i].end());
    }
    ProgressSink progress;
    if (progress_)
      progress = [&](Progress now) {
        now.what = fmt::format("fold {} of {}, {}: {}", fold + 1, recordings.size(),
                               to_string(variant), now.what);
        progress_(now);
      };
    TrainOptions options = options_.train;
    options.variant = variant;
    TrainingSource source = EntitySource::values(reader_, entity_, plan_.layout(), trained);
    if (!options_.augmented.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(source.augmented,
                              find_augmented(options_.augmented, entity_, source, stop_));
    }
    ENGRAM_RETURN_IF_ERROR(add_condition(reader_, entity_, trained.back(), source));
    return train_model(source, options, file, progress, stop_).status();
  }

  Result<idf::Data> value_at(size_t index) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Snapshot snapshot,
                            reader_.read_recorded(entity_, entries_[index]));
    return std::move(snapshot.instances.front().data);
  }

  Result<std::vector<idf::Data>> values_of(const Sequence& recording) {
    std::vector<idf::Data> values;
    for (size_t i = recording.first; i < recording.end; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(values.emplace_back(), value_at(i));
    }
    return values;
  }

  /// Encodes and decodes all recordings. Adds the global codes of the snapshots if `codes` is not
  /// null.
  Status reconstruct_all(encoders::DeepModel& model, const std::vector<Sequence>& recordings,
                         size_t fold, const RepresentationOptions& representation,
                         ReconstructionSums& sums, std::vector<std::vector<float>>* codes) {
    for (size_t i = 0; i < recordings.size(); ++i) {
      BlockChoice choice(model, representation);
      QualitySums& quality = i == fold ? sums.left_out : sums.trained;
      double& bytes = i == fold ? sums.left_out_bytes : sums.trained_bytes;
      ENGRAM_RETURN_IF_ERROR(reconstruct(model, choice, recordings[i], quality, bytes, codes));
    }
    const size_t left_out = recordings[fold].size();
    sums.left_out_bytes /= static_cast<double>(left_out);
    sums.trained_bytes /= static_cast<double>(entries_.size() - left_out);
    return {};
  }

  /// Encodes a recording in blocks and decodes it. Adds the size of the blocks to `bytes`.
  Status reconstruct(encoders::DeepModel& model, BlockChoice& choice, const Sequence& recording,
                     QualitySums& sums, double& bytes, std::vector<std::vector<float>>* codes) {
    ENGRAM_ASSIGN_OR_RETURN(const auto values, values_of(recording));
    for (size_t first = 0; first < values.size(); first += model.block_rows()) {
      if (stop_.stop_requested()) return cancelled("cross-validation was stopped");
      const auto rest = std::span(values).subspan(first);
      const auto block = rest.first(std::min(model.block_rows(), rest.size()));
      ENGRAM_ASSIGN_OR_RETURN(const auto latents, choice.encode(block, stop_));
      bytes += static_cast<double>(latents.front().code.size());
      ENGRAM_ASSIGN_OR_RETURN(const auto chains,
                              model.codec.decode_all(latents.front().code.bytes(), block.size()));
      for (size_t at = 0; at < block.size(); ++at) {
        const encoders::LatentRows& rows = chains[at / model.codec.chain_rows];
        const size_t row = at % model.codec.chain_rows;
        ENGRAM_ASSIGN_OR_RETURN(const idf::Data value,
                                model.decode(rows, row, latents[at].remainder));
        ENGRAM_ASSIGN_OR_RETURN(const auto error, compare(block[at], value));
        ENGRAM_ASSIGN_OR_RETURN(const double ssim, mean_ssim(block[at], value));
        sums.add(error, ssim);
        if (codes == nullptr || !model.global_code.is_known()) continue;
        ENGRAM_ASSIGN_OR_RETURN(codes->emplace_back(),
                                model.global_code_of(rows, row, latents[at].remainder));
      }
    }
    return {};
  }

  using Predictions = Result<std::vector<ltm::Prediction>>;
  using Predict = std::function<Predictions(const ltm::Past& past, int steps)>;

  static Predictions without_estimates(Result<std::vector<idf::Data>> values) {
    ENGRAM_RETURN_IF_ERROR(values.status());
    std::vector<ltm::Prediction> predictions;
    for (idf::Data& value : *values) predictions.push_back({std::move(value), {}});
    return predictions;
  }

  /// Predicts from each two consecutive snapshots of a recording, with as many horizons as there
  /// are sums. The real future of the condition is given as the plan.
  Status measure_predictions(const Sequence& recording,
                             const std::optional<ltm::MemoryId>& condition, const Predict& predict,
                             std::vector<PredictionSums>& sums) {
    ENGRAM_ASSIGN_OR_RETURN(const auto values, values_of(recording));
    std::vector<Time> times;
    for (size_t i = recording.first; i < recording.end; ++i) times.push_back(entries_[i].time);
    ENGRAM_ASSIGN_OR_RETURN(const auto conditions, conditions_at(reader_, condition, times));
    const idf::Type* const type = reader_.manifest().types.of_entity(entity_);
    for (size_t row = 1; row + 1 < values.size(); ++row) {
      if (stop_.stop_requested()) return cancelled("cross-validation was stopped");
      const size_t steps = std::min(sums.size(), values.size() - 1 - row);
      ltm::Past past{std::span<const idf::Data>(values).subspan(row - 1, 2)};
      if (!conditions.empty()) {
        past.conditions = std::span(conditions).subspan(row - 1, 2);
        past.plan = std::span(conditions).subspan(row + 1);
        past.plan = past.plan.first(std::min(past.plan.size(), sums.size()));
      }
      const auto uncounted = ltm::ValueRow(values[row], type).uncounted_paths();
      ENGRAM_ASSIGN_OR_RETURN(const auto futures, predict(past, static_cast<int>(steps)));
      for (size_t ahead = 0; ahead < steps; ++ahead) {
        const idf::Data& recorded = values[row + ahead + 1];
        ENGRAM_ASSIGN_OR_RETURN(const auto error,
                                compare_prediction(recorded, futures[ahead].value, uncounted));
        ENGRAM_ASSIGN_OR_RETURN(const double ssim, mean_ssim(recorded, futures[ahead].value));
        sums[ahead].add(futures[ahead].error, error, ssim);
      }
    }
    return {};
  }

  ltm::StoreReader& reader_;
  const ltm::MemoryId& entity_;
  const CrossvalOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  const FoldSink& on_fold_;
  std::vector<ltm::SnapshotEntry> entries_;  ///< Measured snapshots.
  /// Per recording, the snapshots in between, which are only trained on, as slower recordings one
  /// after another.
  std::vector<std::vector<ltm::SnapshotEntry>> between_;
  encoders::TensorPlan plan_;
};

/// The one entity that a query matches.
Result<ltm::MemoryId> only_match(const ltm::StoreReader& reader, const std::string& text) {
  ENGRAM_ASSIGN_OR_RETURN(const auto matching, matching_entities(reader, {&text, 1}));
  if (matching.empty())
    return not_found("store '{}': none of its {} entities matches '{}'", reader.path().string(),
                     reader.entities().size(), text);
  if (matching.size() > 1)
    return invalid_argument("store '{}': '{}' matches {} entities, needs one",
                            reader.path().string(), text, matching.size());
  return matching.front();
}

}  // namespace

Result<CrossvalReport> crossval(const std::filesystem::path& store, const CrossvalOptions& options,
                                const ProgressSink& progress, const std::stop_token& stop,
                                const FoldSink& on_fold) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, only_match(*reader, options.entity));
  return Crossval(*reader, entity, options, progress, stop, on_fold).run();
}

}  // namespace engram::training
