// SPDX-License-Identifier: Apache-2.0
#include "training/fit/trainer.h"

#include <algorithm>
#include <cmath>

#include "encoders/deep_model_file.h"
#include "encoders/threads.h"
#include "encoders/weight_rounding.h"
#include "ltm/core/free_memory.h"
#include "training/fit/checkpoint.h"
#include "training/fit/fit_autoencoder.h"
#include "training/fit/fit_codec.h"
#include "training/fit/fit_dynamics.h"
#include "training/fit/fit_global_code.h"
#include "training/fit/fit_motion.h"
#include "training/fit/load_dataset.h"
#include "training/fit/measure_prediction.h"
#include "training/fit/network_width.h"
#include "training/fit/warm_start.h"
#include "training/fit/windows.h"

namespace engram::training {

namespace {

constexpr std::string_view kCodeVersion = "0.1.0";
/// Shares of the budget, or of the steps, for the autoencoder and for motion.
constexpr double kAutoencoderShare = 0.72;
constexpr double kMotionShare = 0.2;
constexpr size_t kFewestSnapshots = 2;
encoders::NetworkSizes sizes_of(const TrainOptions& options, size_t snapshots,
                                const Dataset& data) {
  return {network_width(options, snapshots), options.coarse_channels, options.fine_channels,
          options.has_networks ? data.scenes() : 1,
          data.condition ? static_cast<int>(data.conditions.size(1)) : 0};
}

std::string text_of(const FitStep& step, std::string_view phase, size_t epoch) {
  std::string text = fmt::format("{}, epoch {}, ", phase, epoch);
  if (step.psnr_db > 0) return text + fmt::format("{:.2f} dB, {:.0f} B", step.psnr_db, step.bytes);
  return text + fmt::format("loss {:.4f}", step.loss);
}

/// One part of training, as shares of the whole.
struct Part {
  std::string_view name;
  double before = 0;
  double share = 0;

  [[nodiscard]] double after() const { return 1 - before - share; }
};

/// The schedule of a part, which leaves time for the parts after it.
Schedule schedule_of(const TrainOptions& options, const TrainControl& control, const Part& part) {
  if (control.end && !options.steps) return Schedule(*control.end, part.share, part.after());
  std::optional<int> steps;
  if (options.steps) steps = static_cast<int>(*options.steps * part.share);
  return Schedule(steps, to_seconds(options.budget) * part.share);
}

/// Reports progress in steps if their number is fixed, else in thousandths of the time.
StepSink step_sink(const ProgressSink& progress, const std::string& entity,
                   const TrainOptions& options, const TrainControl& control, const Part& part,
                   size_t steps_per_epoch, const Schedule& schedule) {
  return [=, &progress, &schedule](const FitStep& step) {
    constexpr double kParts = 1000;
    const double total = options.steps ? *options.steps : kParts;
    const double done =
        total * (part.before + part.share * std::min(schedule.share(step.step), 1.0));
    const auto epoch = static_cast<size_t>(step.step) / std::max<size_t>(steps_per_epoch, 1) + 1;
    Progress now{"train " + entity,
                 static_cast<uint64_t>(options.steps ? std::round(done) : std::floor(done)),
                 static_cast<uint64_t>(total), text_of(step, part.name, epoch), -1};
    if (control.end)
      now.seconds_left = std::max(0.0, to_seconds(*control.end - system_now()));
    else if (!options.steps)
      now.seconds_left =
          schedule.seconds_left(step.step) + to_seconds(options.budget) * part.after();
    progress(now);
  };
}

/// Adds the spans of an earlier model that no new span contains.
void add_spans(std::vector<encoders::TimeSpan>& spans,
               const std::vector<encoders::TimeSpan>& earlier) {
  std::vector<encoders::TimeSpan> all;
  for (const encoders::TimeSpan& old : earlier)
    if (std::ranges::none_of(spans, [&](const encoders::TimeSpan& span) {
          return span.contains(old.first) && span.contains(old.last);
        }))
      all.push_back(old);
  all.insert(all.end(), spans.begin(), spans.end());
  std::ranges::sort(all, {}, &encoders::TimeSpan::first);
  spans = std::move(all);
}

/// The recordings of a source that are trained on.
std::vector<Sequence> trained_recordings(const TrainingSource& source, const Dataset& data) {
  std::vector<Sequence> recordings = cut_sequences(source.times);
  recordings.resize(recordings.size() - data.left_out_sequences);
  return recordings;
}

/// Writes the description of the data for the report and the model file. Spans are those of whole
/// recordings, even if only runs of them were in memory: a snapshot between two runs is seconds
/// from what was trained on, and does not count as never seen.
void describe(const TrainingSource& source, const Dataset& data, const WarmStart& start,
              encoders::Provenance& provenance) {
  provenance.snapshots = static_cast<int64_t>(data.size());
  for (const Sequence& recording : trained_recordings(source, data)) {
    provenance.autoencoder_spans.push_back(
        {source.times[recording.first], source.times[recording.end - 1]});
    const size_t end = held_out_from(recording);
    if (end > recording.first)
      provenance.dynamics_spans.push_back({source.times[recording.first], source.times[end - 1]});
  }
  if (!start.model) return;
  add_spans(provenance.autoencoder_spans, start.model->provenance.autoencoder_spans);
  add_spans(provenance.dynamics_spans, start.model->provenance.dynamics_spans);
}

void add_notes(const TrainingSource& source, const Dataset& data, const Checkpoints& checkpoints,
               const WarmStart& start, bool has_networks, TrainReport& report) {
  if (!start.note.empty()) report.notes.push_back(start.note);
  if (const Checkpoint* found = checkpoints.found())
    report.notes.push_back(fmt::format("training went on where it was interrupted: {:.0f} % of {}",
                                       100 * found->share, name_of(found->phase)));
  if (data.left_out_sequences > 0)
    report.notes.push_back(
        fmt::format("{} recordings were left out of training", data.left_out_sequences));
  else if (data.size() < source.times.size())
    report.notes.push_back(
        has_networks
            ? fmt::format("{} of {} snapshots fit into memory; evenly spaced runs of them took "
                          "turns while the autoencoder was trained",
                          data.size(), source.times.size())
            : fmt::format("predictions were measured on {} of {} snapshots, in evenly spaced runs",
                          data.size(), source.times.size()));
  if (source.augmented) {
    const size_t used = data.augmented ? data.augmented->size() : 0;
    size_t others = source.augmented->left_out;
    for (const auto& run : source.augmented->origins) others += run.size();
    report.notes.push_back(fmt::format(
        "{} augmented values were trained on, too; {} were made of what is not trained on", used,
        others - used));
  }
  if (make_windows(data.sequences, data.first_held_out, 1).held_out.empty())
    report.notes.push_back("no recording is long enough to test predictions: they copy the last");
}

/// Removes all gradients: they are as large as the weights, and users of the model need none.
void forget_gradients(encoders::DeepModel& model) {
  for (const auto& weights : model.autoencoder->parameters()) weights.mutable_grad().reset();
  for (const auto& weights : model.dynamics->parameters()) weights.mutable_grad().reset();
}

Result<FittedModel> fit_checked(const TrainingSource& source, const TrainOptions& options,
                                JobPace& pace, const TrainControl& control,
                                Checkpoints& checkpoints) {
  encoders::set_threads(options.threads);
  ENGRAM_ASSIGN_OR_RETURN(const WarmStart start, find_start(source, options));
  torch::manual_seed(options.seed);

  // The data is read first: it decides the sizes of the networks.
  ENGRAM_ASSIGN_OR_RETURN(Dataset data,
                          load_dataset(source, options, start.model.get(), pace.stop()));
  give_back_memory();

  // The model starts from random weights, or from those of the previous model.
  const auto made = std::make_shared<encoders::DeepModel>(
      data.plan, sizes_of(options, source.times.size(), data));
  encoders::DeepModel& model = *made;
  if (start.model) copy_weights(*start.model, model);
  model.mean = data.mean;
  model.deviation = data.deviation;
  model.condition = data.condition;

  // The autoencoder and its codec come first, then prediction, which is trained on the weights that
  // will be stored.
  const size_t epoch = data.size() / static_cast<size_t>(options.batch_size);
  const bool has_networks = !model.autoencoder->images.empty();
  const Part coding{name_of(FitPhase::kAutoencoder), 0, has_networks ? kAutoencoderShare : 0};
  Schedule coding_time = schedule_of(options, control, coding);
  FitLoop coding_loop(
      FitPhase::kAutoencoder, coding_time, pace, checkpoints,
      step_sink(pace.progress(), source.entity, options, control, coding, epoch, coding_time));
  FitSpeed speed;
  ENGRAM_ASSIGN_OR_RETURN(checkpoints.coded,
                          fit_autoencoder(model, source, data, options, coding_loop, speed));
  encoders::round_weights(*model.autoencoder);
  give_back_memory();
  const LatentTable latents = encode_all(model, data);
  ENGRAM_RETURN_IF_ERROR(fit_codec(model, data, latents, options));
  fit_global_code(model, data, latents);
  give_back_memory();
  const double moving_share = has_networks ? kMotionShare : 0;
  const Part predicting{name_of(FitPhase::kDynamics), coding.share,
                        1 - coding.share - moving_share};
  Schedule predicting_time = schedule_of(options, control, predicting);
  FitLoop predicting_loop(FitPhase::kDynamics, predicting_time, pace, checkpoints,
                          step_sink(pace.progress(), source.entity, options, control, predicting,
                                    epoch, predicting_time));
  ENGRAM_ASSIGN_OR_RETURN(checkpoints.predicted,
                          fit_dynamics(model, data, latents, options, predicting_loop));
  give_back_memory();
  const Part moving{name_of(FitPhase::kMotion), 1 - moving_share, moving_share};
  Schedule moving_time = schedule_of(options, control, moving);
  FitLoop moving_loop(
      FitPhase::kMotion, moving_time, pace, checkpoints,
      step_sink(pace.progress(), source.entity, options, control, moving, epoch, moving_time));
  ENGRAM_ASSIGN_OR_RETURN(const FitStep motion, fit_motion(model, data, options, moving_loop));
  give_back_memory();
  encoders::round_weights(*model.dynamics);
  measure_prediction(model, data);

  // The report and the provenance in the model file tell the same facts.
  const FitStep& coded = checkpoints.coded;
  TrainReport report;
  report.snapshots = source.times.size();
  report.used_snapshots = data.size();
  report.sequences = trained_recordings(source, data).size() + data.left_out_sequences;
  report.augmented = data.augmented ? data.augmented->size() : 0;
  report.autoencoder_steps = coded.step;
  report.dynamics_steps = checkpoints.predicted.step + motion.step;
  report.final_loss = coded.loss;
  report.training_psnr_db = coded.psnr_db;
  report.started_from = start.model ? source.previous->version : 0;
  add_notes(source, data, checkpoints, start, options.has_networks, report);
  report.seconds = checkpoints.seconds();
  report.images_per_second = speed.images_per_second();
  auto& provenance = model.provenance;
  provenance.entity = source.entity;
  provenance.code_version = kCodeVersion;
  provenance.seed = options.seed;
  provenance.variant = options.variant;
  provenance.steps = coded.step + report.dynamics_steps;
  // With a fixed number of steps the same seed must give the same file, so times are left out.
  provenance.training_seconds = options.steps ? 0 : report.seconds;
  provenance.final_loss = coded.loss;
  provenance.psnr_db = options.psnr_db;
  provenance.error_price = coded.price;
  provenance.prior_bytes = coded.bytes;
  provenance.number_bound = options.number_bound;
  provenance.started_from = report.started_from;
  provenance.forgotten = start.model ? std::min(source.forgotten, start.model->provenance.forgotten)
                                     : source.forgotten;
  provenance.curve = checkpoints.curve.points();
  if (options.steps)
    for (encoders::CurvePoint& point : provenance.curve) point.seconds = 0;
  describe(source, data, start, provenance);
  forget_gradients(model);
  return FittedModel{made, std::move(report)};
}

}  // namespace

Result<FittedModel> fit_model(const TrainingSource& source, const TrainOptions& options,
                              const ProgressSink& progress, const std::stop_token& stop,
                              const TrainControl& control) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  if (source.times.size() < kFewestSnapshots)
    return invalid_argument("{}: found {} snapshots to train on, needs {}", source.entity,
                            source.times.size(), kFewestSnapshots);
  JobPace alone(nullptr, progress, stop);
  JobPace& pace = control.pace != nullptr ? *control.pace : alone;
  Checkpoints checkpoints(control.checkpoint, checkpoint_key(source, options),
                          control.checkpoint_interval);
  return encoders::guarded("train " + source.entity, [&] {
    auto fitted = fit_checked(source, options, pace, control, checkpoints);
    if (fitted.ok() || !checkpoints.has_refused()) return fitted;
    return fit_checked(source, options, pace, control, checkpoints);
  });
}

Result<TrainReport> train_model(const TrainingSource& source, const TrainOptions& options,
                                const std::filesystem::path& file, const ProgressSink& progress,
                                const std::stop_token& stop, const TrainControl& control) {
  ENGRAM_ASSIGN_OR_RETURN(FittedModel fitted, fit_model(source, options, progress, stop, control));
  ENGRAM_RETURN_IF_ERROR(encoders::save_model(*fitted.model, file));
  return std::move(fitted.training);
}

}  // namespace engram::training
