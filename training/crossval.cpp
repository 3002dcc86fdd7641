// SPDX-License-Identifier: Apache-2.0
#include "training/crossval.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "encoders/deep_model_file.h"
#include "ltm/memory/query.h"
#include "ltm/store/temporary_file.h"
#include "training/block_choice.h"
#include "training/condition_source.h"
#include "training/entity_source.h"
#include "training/quality_json.h"
#include "training/quality_sums.h"
#include "training/sequences.h"

namespace engram::training {

namespace {

constexpr size_t kHorizons = 2;

/// What a fold collects.
struct FoldSums {
  QualitySums trained, left_out;
  std::array<std::array<QualitySums, kHorizons>, kPredictings> prediction;
};

/// A value as a straight line from the last two would have it.
Result<idf::Data> extrapolated(const encoders::DeepModel& model, const idf::Data& last,
                               const idf::Data& before, double steps) {
  ENGRAM_ASSIGN_OR_RETURN(const auto now_split, model.plan.layout().split(last));
  ENGRAM_ASSIGN_OR_RETURN(const auto before_split, model.plan.layout().split(before));
  ENGRAM_ASSIGN_OR_RETURN(encoders::Parts now, model.to_parts(now_split));
  ENGRAM_ASSIGN_OR_RETURN(const encoders::Parts then, model.to_parts(before_split));
  for (size_t i = 0; i < now.images.size(); ++i)
    now.images[i] = (now.images[i] + steps * (now.images[i] - then.images[i])).clamp(0, 255);
  if (now.numbers.defined()) now.numbers = now.numbers + steps * (now.numbers - then.numbers);
  return model.to_value(model.to_arrays(now), model.to_numbers(now), now_split.remainder);
}

/// Trains and measures folds of one entity.
class Crossval {
 public:
  Crossval(ltm::StoreReader& reader, const ltm::MemoryId& entity, const CrossvalOptions& options,
           const ProgressSink& progress, const std::stop_token& stop)
      : reader_(reader), entity_(entity), options_(options), progress_(progress), stop_(stop) {}

  Result<CrossvalReport> run() {
    ENGRAM_ASSIGN_OR_RETURN(EntitySource found,
                            EntitySource::find(reader_, entity_, 2, false, stop_));
    if (!found.missing.empty())
      return invalid_argument("{}: {}", entity_.to_string(), found.missing);
    entries_ = std::move(found.entries);
    std::vector<Time> times;
    for (const ltm::SnapshotEntry& entry : entries_) times.push_back(entry.time);
    const std::vector<Sequence> recordings = cut_sequences(times);
    if (recordings.size() < 2)
      return invalid_argument("{}: found {} recording, needs two to leave one out",
                              entity_.to_string(), recordings.size());
    CrossvalReport report;
    report.entity = entity_;
    const size_t folds =
        std::min(options_.most_folds.value_or(recordings.size()), recordings.size());
    for (size_t fold = 0; fold < folds; ++fold) {
      ENGRAM_ASSIGN_OR_RETURN(report.folds.emplace_back(), run_fold(recordings, fold));
    }
    report.all = fold_of(all_);
    for (const CrossvalFold& fold : report.folds) {
      report.all.snapshots += fold.snapshots;
      report.all.trained_bytes += fold.trained_bytes / static_cast<double>(folds);
      report.all.left_out_bytes += fold.left_out_bytes / static_cast<double>(folds);
      report.all.model_bytes += fold.model_bytes / folds;
    }
    return report;
  }

 private:
  static CrossvalFold fold_of(const FoldSums& sums) {
    CrossvalFold fold;
    fold.trained = sums.trained.quality();
    fold.left_out = sums.left_out.quality();
    for (size_t way = 0; way < kPredictings; ++way)
      for (size_t h = 0; h < kHorizons; ++h)
        fold.prediction[way][h] = sums.prediction[way][h].quality();
    return fold;
  }

  Result<CrossvalFold> run_fold(const std::vector<Sequence>& recordings, size_t fold) {
    const Sequence& left_out = recordings[fold];
    std::vector<ltm::SnapshotEntry> trained(entries_);
    trained.erase(trained.begin() + static_cast<ptrdiff_t>(left_out.first),
                  trained.begin() + static_cast<ptrdiff_t>(left_out.end));
    ENGRAM_ASSIGN_OR_RETURN(const auto file,
                            ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
    ProgressSink progress;
    if (progress_)
      progress = [&](Progress now) {
        now.what = fmt::format("fold {} of {}: {}", fold + 1, recordings.size(), now.what);
        progress_(now);
      };
    TrainingSource source = EntitySource::values(reader_, entity_, trained);
    ENGRAM_RETURN_IF_ERROR(ConditionSource::add(reader_, entity_, trained.back(), source));
    ENGRAM_RETURN_IF_ERROR(
        train_model(source, options_.train, file.path(), progress, stop_).status());
    ENGRAM_ASSIGN_OR_RETURN(const auto model, encoders::read_model(file.path()));
    FoldSums sums;
    double trained_bytes = 0;
    size_t trained_snapshots = 0;
    for (size_t i = 0; i < recordings.size(); ++i) {
      if (i == fold) continue;
      ENGRAM_ASSIGN_OR_RETURN(const double bytes,
                              reconstruct(*model, recordings[i], sums.trained, all_.trained));
      trained_bytes += bytes;
      trained_snapshots += recordings[i].size();
    }
    ENGRAM_ASSIGN_OR_RETURN(const double left_out_bytes,
                            reconstruct(*model, left_out, sums.left_out, all_.left_out));
    ENGRAM_RETURN_IF_ERROR(predict(model, left_out, sums));
    CrossvalFold result = fold_of(sums);
    result.first = entries_[left_out.first].time;
    result.snapshots = left_out.size();
    result.trained_bytes = trained_bytes / static_cast<double>(trained_snapshots);
    result.left_out_bytes = left_out_bytes / static_cast<double>(left_out.size());
    std::error_code failed;
    result.model_bytes = std::filesystem::file_size(file.path(), failed);
    if (failed) return unavailable("model '{}': {}", file.path().string(), failed.message());
    return result;
  }

  Result<std::vector<idf::Data>> values_of(const Sequence& recording) {
    std::vector<idf::Data> values;
    for (size_t i = recording.first; i < recording.end; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(ltm::Snapshot snapshot, reader_.read_recorded(entity_, entries_[i]));
      values.push_back(std::move(snapshot.instances.front().data));
    }
    return values;
  }

  /// Bytes of the codes of a recording, in blocks that decode alone.
  Result<double> reconstruct(encoders::DeepModel& model, const Sequence& recording,
                             QualitySums& sums, QualitySums& all) {
    ENGRAM_ASSIGN_OR_RETURN(const auto values, values_of(recording));
    RepresentationOptions representation;
    representation.kind = Representation::kLatents;
    representation.refine_steps = options_.refine_steps;
    BlockChoice choice(model, representation);
    double bytes = 0;
    for (size_t first = 0; first < values.size(); first += model.block_rows) {
      if (stop_.stop_requested()) return cancelled("cross-validation was stopped");
      const auto block =
          std::span(values).subspan(first).first(std::min(model.block_rows, values.size() - first));
      ENGRAM_ASSIGN_OR_RETURN(const auto latents, choice.encode(block, stop_));
      bytes += static_cast<double>(latents.front().code.size());
      ENGRAM_ASSIGN_OR_RETURN(const auto rows, model.codec.decode(latents.front().code.bytes(),
                                                                  block.size(), block.size()));
      for (size_t row = 0; row < block.size(); ++row) {
        ENGRAM_ASSIGN_OR_RETURN(const idf::Data value,
                                model.decode(rows, row, latents[row].remainder));
        ENGRAM_ASSIGN_OR_RETURN(const auto error, compare(block[row], value));
        sums.add(error);
        all.add(error);
      }
    }
    return bytes;
  }

  Status predict(const std::shared_ptr<encoders::DeepModel>& model, const Sequence& recording,
                 FoldSums& sums) {
    ENGRAM_ASSIGN_OR_RETURN(const auto values, values_of(recording));
    const auto predictor = encoders::make_predictor(model);
    std::vector<Time> times;
    for (size_t i = recording.first; i < recording.end; ++i) times.push_back(entries_[i].time);
    ENGRAM_ASSIGN_OR_RETURN(const auto conditions,
                            ConditionSource::at_all(reader_, predictor->condition(), times));
    for (size_t row = 1; row + 1 < values.size(); ++row) {
      if (stop_.stop_requested()) return cancelled("cross-validation was stopped");
      const size_t steps = std::min(kHorizons, values.size() - 1 - row);
      ENGRAM_ASSIGN_OR_RETURN(
          const auto futures,
          predictor->predict({std::span(values).subspan(row - 1, 2),
                              std::span(conditions).subspan(conditions.empty() ? 0 : row - 1,
                                                            conditions.empty() ? 0 : 2)},
                             static_cast<int>(steps)));
      for (size_t h = 0; h < steps; ++h) {
        ENGRAM_ASSIGN_OR_RETURN(
            const idf::Data line,
            extrapolated(*model, values[row], values[row - 1], static_cast<double>(h + 1)));
        const std::array<const idf::Data*, kPredictings> predicted{&futures[h], &values[row],
                                                                   &line};
        for (size_t way = 0; way < kPredictings; ++way) {
          ENGRAM_ASSIGN_OR_RETURN(const auto error, compare(values[row + h + 1], *predicted[way]));
          sums.prediction[way][h].add(error);
          all_.prediction[way][h].add(error);
        }
      }
    }
    return {};
  }

  ltm::StoreReader& reader_;
  const ltm::MemoryId& entity_;
  const CrossvalOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::vector<ltm::SnapshotEntry> entries_;
  FoldSums all_;
};

/// The one entity that a query matches.
Result<ltm::MemoryId> only_match(const ltm::StoreReader& reader, const std::string& text) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse(text));
  std::vector<ltm::MemoryId> matching;
  for (const ltm::MemoryId& entity : reader.entities())
    if (query.matches(entity)) matching.push_back(entity);
  if (matching.empty())
    return not_found("store '{}': none of its {} entities matches '{}'", reader.path().string(),
                     reader.entities().size(), text);
  if (matching.size() > 1)
    return invalid_argument("store '{}': '{}' matches {} entities, needs one",
                            reader.path().string(), text, matching.size());
  return matching.front();
}

nlohmann::ordered_json to_json(const CrossvalFold& fold) {
  nlohmann::ordered_json json{{"snapshots", fold.snapshots},
                              {"trained", quality_json(fold.trained)},
                              {"left_out", quality_json(fold.left_out)},
                              {"trained_bytes", fold.trained_bytes},
                              {"left_out_bytes", fold.left_out_bytes},
                              {"model_bytes", fold.model_bytes}};
  for (size_t way = 0; way < kPredictings; ++way)
    for (size_t h = 0; h < kHorizons; ++h)
      json[std::string(to_string(static_cast<Predicting>(way)))].push_back(
          quality_json(fold.prediction[way][h]));
  return json;
}

}  // namespace

Status CrossvalOptions::validate() const {
  if (most_folds && *most_folds < 1) return invalid_argument("folds: found 0, needs at least 1");
  return train.validate();
}

std::string_view to_string(Predicting predicting) {
  constexpr std::array<std::string_view, kPredictings> kNames{"model", "copy-last", "linear"};
  return kNames[static_cast<size_t>(predicting)];
}

Result<CrossvalReport> crossval(const std::filesystem::path& store, const CrossvalOptions& options,
                                const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, only_match(*reader, options.entity));
  return Crossval(*reader, entity, options, progress, stop).run();
}

nlohmann::ordered_json to_json(const CrossvalReport& report) {
  nlohmann::ordered_json folds = nlohmann::ordered_json::array();
  for (const CrossvalFold& fold : report.folds) {
    folds.push_back(to_json(fold));
    folds.back()["left_out_from"] = engram::to_string(fold.first);
  }
  return {{"entity", report.entity.to_string()}, {"folds", folds}, {"all", to_json(report.all)}};
}

}  // namespace engram::training
