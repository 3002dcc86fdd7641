// SPDX-License-Identifier: Apache-2.0
#include "training/trainer.h"

#include "encoders/deep_model_file.h"
#include "encoders/threads.h"
#include "training/fit.h"

namespace engram::training {

namespace {

constexpr std::string_view kCodeVersion = "0.1.0";
/// Share of the budget, or of the steps, that the autoencoder gets.
constexpr double kAutoencoderShare = 0.75;
constexpr size_t kFewestSnapshots = 2;

/// Features that pay for their bytes in the model file. Source: docs/learning.md.
int chosen_width(const TrainOptions& options, size_t snapshots) {
  if (options.width > 0) return options.width;
  if (snapshots < 2000) return 32;
  return snapshots < 20000 ? 48 : 64;
}

Schedule schedule_of(const TrainOptions& options, double share) {
  std::optional<int> steps;
  if (options.steps) steps = static_cast<int>(*options.steps * share);
  return Schedule(steps, to_seconds(options.budget) * share);
}

/// Tells progress as a share of the budget, or of the steps where their number is fixed.
StepSink step_sink(const ProgressSink& progress, const std::string& entity,
                   const TrainOptions& options, std::string_view phase, size_t steps_per_epoch,
                   double share_before, double share_after) {
  if (!progress) return [](int64_t, double, double) {};
  return [=, phase = std::string(phase)](int64_t step, double loss, double seconds_left) {
    Progress now{"train " + entity, 0, 0, {}, -1};
    now.detail =
        fmt::format("{}, epoch {}, loss {:.4f}", phase,
                    static_cast<size_t>(step) / std::max<size_t>(steps_per_epoch, 1) + 1, loss);
    if (options.steps) {
      now.total = static_cast<uint64_t>(*options.steps);
      now.done = static_cast<uint64_t>(step + static_cast<int64_t>(*options.steps * share_before));
    } else {
      const double budget = to_seconds(options.budget);
      now.seconds_left = seconds_left + budget * share_after;
      now.total = static_cast<uint64_t>(budget * 1000);
      now.done = static_cast<uint64_t>(std::max(0.0, budget - now.seconds_left) * 1000);
    }
    progress(now);
  };
}

/// What a report and the model file say about the data.
void describe(const Dataset& data, encoders::Provenance& provenance) {
  provenance.snapshots = static_cast<int64_t>(data.size());
  for (const Sequence& sequence : data.sequences) {
    provenance.autoencoder_spans.push_back(
        {data.times[sequence.first], data.times[sequence.end - 1]});
    const size_t end = held_out_from(sequence);
    if (end > sequence.first)
      provenance.dynamics_spans.push_back({data.times[sequence.first], data.times[end - 1]});
  }
}

encoders::LatentCoder make_coder(encoders::DeepModel& model, const Dataset& data) {
  encoders::LatentStatistics statistics(model.autoencoder->shape.grids());
  for (size_t row = 0; row < data.size(); ++row) statistics.add(latents_of(model, data, row));
  return statistics.coder();
}

void add_notes(const TrainingSource& source, const Dataset& data, TrainReport& report) {
  if (data.left_out_sequences > 0)
    report.notes.push_back(
        fmt::format("{} recordings were left out of training", data.left_out_sequences));
  else if (data.size() < source.times.size())
    report.notes.push_back(fmt::format("{} of {} snapshots fit into memory, in evenly spaced runs",
                                       data.size(), source.times.size()));
  if (make_windows(data.sequences, 1).held_out.empty())
    report.notes.push_back("no recording is long enough to test predictions: they copy the last");
}

Result<TrainReport> train_checked(const TrainingSource& source, const TrainOptions& options,
                                  const std::filesystem::path& file, const ProgressSink& progress,
                                  const std::stop_token& stop) {
  const auto start = std::chrono::steady_clock::now();
  encoders::set_threads(options.threads);
  torch::manual_seed(options.seed);

  // Data.
  ENGRAM_ASSIGN_OR_RETURN(const Dataset data, load_dataset(source, options, stop));

  // Model.
  encoders::DeepModel model(data.plan,
                            encoders::network_shape(data.plan, chosen_width(options, data.size()),
                                                    options.latent_channels));
  model.mean = data.mean;
  model.deviation = data.deviation;

  // The autoencoder, then the dynamics of what it codes: each on the weights that will be stored.
  const size_t epoch = data.size() / static_cast<size_t>(options.batch_size);
  ENGRAM_ASSIGN_OR_RETURN(
      const FitResult coded,
      fit_autoencoder(model, data, options, schedule_of(options, kAutoencoderShare), stop,
                      step_sink(progress, source.entity, options, "autoencoder", epoch, 0,
                                1 - kAutoencoderShare)));
  encoders::round_weights(*model.autoencoder);
  model.coder = make_coder(model, data);
  ENGRAM_ASSIGN_OR_RETURN(
      const FitResult dynamics,
      fit_dynamics(model, data, options, schedule_of(options, 1 - kAutoencoderShare), stop,
                   step_sink(progress, source.entity, options, "dynamics", epoch,
                             kAutoencoderShare, 0)));
  encoders::round_weights(*model.dynamics);
  model.prediction.step = median_step(data.times);
  ENGRAM_RETURN_IF_ERROR(measure_prediction(model, data));

  // Report.
  TrainReport report;
  report.snapshots = source.times.size();
  report.used_snapshots = data.size();
  report.sequences = data.sequences.size() + data.left_out_sequences;
  report.autoencoder_steps = coded.steps;
  report.dynamics_steps = dynamics.steps;
  report.final_loss = coded.loss;
  add_notes(source, data, report);
  report.seconds = to_seconds(std::chrono::steady_clock::now() - start);
  auto& provenance = model.provenance;
  provenance.entity = source.entity;
  provenance.code_version = kCodeVersion;
  provenance.seed = options.seed;
  provenance.steps = coded.steps + dynamics.steps;
  // Under a fixed number of steps the same seed gives the same file.
  provenance.training_seconds = options.steps ? 0 : report.seconds;
  provenance.final_loss = coded.loss;
  provenance.lambda = options.lambda;
  provenance.number_error = options.number_error;
  describe(data, provenance);
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data example, source.read(0));
  ENGRAM_RETURN_IF_ERROR(encoders::save_model(model, example, file));
  return report;
}

}  // namespace

Status TrainOptions::validate() const {
  if (!steps && budget <= Duration::zero())
    return invalid_argument("training budget: found {}, needs more than zero", to_string(budget));
  if (steps && *steps < 1) return invalid_argument("training steps: found {}, needs 1", *steps);
  if (batch_size < 1) return invalid_argument("batch size: found {}, needs 1", batch_size);
  if (!(lambda > 0)) return invalid_argument("lambda: found {}, needs more than zero", lambda);
  if (!(number_error > 0))
    return invalid_argument("number error: found {}, needs more than zero", number_error);
  if (width != 0 && (width < 8 || width > 512 || width % 2 != 0))
    return invalid_argument("width: found {}, needs 0 or an even number of 8 to 512", width);
  if (latent_channels < 1 || latent_channels > 64)
    return invalid_argument("latent channels: found {}, needs 1 to 64", latent_channels);
  if (!(moving_weight >= 1))
    return invalid_argument("moving weight: found {}, needs at least 1", moving_weight);
  if (threads < 1) return invalid_argument("threads: found {}, needs at least 1", threads);
  if (hold_out_recordings < 0)
    return invalid_argument("recordings to leave out: found {}, needs 0 or more",
                            hold_out_recordings);
  return {};
}

Result<TrainReport> train_model(const TrainingSource& source, const TrainOptions& options,
                                const std::filesystem::path& file, const ProgressSink& progress,
                                const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  if (source.times.size() < kFewestSnapshots)
    return invalid_argument("{}: found {} snapshots to train on, needs {}", source.entity,
                            source.times.size(), kFewestSnapshots);
  return encoders::guarded("train " + source.entity,
                           [&] { return train_checked(source, options, file, progress, stop); });
}

}  // namespace engram::training
