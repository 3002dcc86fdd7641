// SPDX-License-Identifier: Apache-2.0
#include "training/night/consolidate_entity.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "encoders/deep_model_file.h"
#include "ltm/store/publish.h"
#include "training/night/compare_models.h"
#include "training/night/encode_entity.h"
#include "training/night/encode_groups.h"
#include "training/night/entity_report.h"
#include "training/night/expected_encoding.h"
#include "training/night/fit_entity.h"
#include "training/night/previous_model.h"
#include "training/night/publish_entity.h"
#include "training/night/video_alone.h"

namespace engram::training {

namespace {

/// A second model, without networks for images, gets the time divided by this.
constexpr int kSecondShare = 10;

/// A fitted model, all snapshots encoded with it, and its file.
struct MadeModel {
  FittedModel fitted;
  EncodedEntity encoded;
  ModelFile file;
  size_t wanted = 0;            ///< Snapshots to encode; fewer were if the time was over.
  double encoding_seconds = 0;  ///< Includes the models made before it.
};

/// Fits a model, encodes all snapshots with it, and writes it with the forms in which they were
/// kept.
Result<OrSkipped<MadeModel>> make(const EntityWork& work, const PlannedEntity& planned,
                                  const TrainingSource& source, const ChosenForm& form,
                                  const Allotment& time) {
  using Made = OrSkipped<MadeModel>;
  ENGRAM_ASSIGN_OR_RETURN(auto fitted,
                          or_skipped(fit_entity(work, planned, source, form, time), work.pace));
  if (auto* skipped = std::get_if<Skipped>(&fitted)) return Made(std::move(*skipped));
  auto& model = std::get<FittedModel>(fitted);
  const int version = ltm::next_model_version(work.reader.manifest(), work.entity);
  ENGRAM_ASSIGN_OR_RETURN(auto encoded,
                          or_skipped(encode_entity(work, model.model, version, planned.entries,
                                                   form.representation, limits_of(time)),
                                     work.pace));
  if (auto* skipped = std::get_if<Skipped>(&encoded)) return Made(std::move(*skipped));
  auto& snapshots = std::get<EncodedEntity>(encoded);
  if (snapshots.snapshots == 0) return Made(nothing_encoded());
  model.model->provenance.forms = snapshots.quality.forms;
  ENGRAM_ASSIGN_OR_RETURN(ModelFile file, write_model_file(work, *model.model));
  const double seconds = snapshots.seconds;
  return Made(MadeModel{std::move(model), std::move(snapshots), std::move(file),
                        planned.entries.size(), seconds});
}

/// Time to encode everything as video alone; nothing if the time is over.
std::optional<Allotment> second_allotment(const Allotment& first, double encoding_seconds) {
  Allotment second = first;
  second.budget = first.budget / kSecondShare;
  if (!first.end) return second;
  const double left =
      to_seconds(*first.encoded_end - system_now()) - with_encoding_margin(encoding_seconds);
  second.budget = std::min(
      second.budget, std::chrono::duration_cast<Duration>(std::chrono::duration<double>(left)));
  if (second.budget <= Duration::zero()) return std::nullopt;
  second.end = system_now() + second.budget;
  return second;
}

/// Returns the new model, or one of video alone if that takes fewer bytes, with the reason in a
/// note. If the time ends before, the first model is still valid, only larger.
Result<OrSkipped<MadeModel>> or_video_alone(const EntityWork& work, const PlannedEntity& planned,
                                            const TrainingSource& source, const ChosenForm& form,
                                            const Allotment& time, MadeModel made,
                                            NightHistory& history,
                                            std::vector<std::string>& notes) {
  using Made = OrSkipped<MadeModel>;
  if (form.representation.kind != Representation::kAuto) return Made(std::move(made));
  auto why = why_video_is_cheaper(made.encoded, made.file.bytes,
                                  work.options.representation.first_nights());
  history.networks_lost_at = 0;
  if (!why) return Made(std::move(made));
  notes.push_back(*std::move(why));
  ENGRAM_ASSIGN_OR_RETURN(history.networks_lost_at, snapshots_ever(work.reader, work.entity));
  const auto second = second_allotment(time, made.encoding_seconds);
  if (!second) return Made(std::move(made));
  ENGRAM_ASSIGN_OR_RETURN(Made again, make(work, planned, source, form.as_video_alone(), *second));
  if (const auto* skipped = std::get_if<Skipped>(&again); skipped != nullptr && skipped->is_late)
    return Made(std::move(made));
  if (auto* video = std::get_if<MadeModel>(&again))
    video->encoding_seconds += made.encoding_seconds;
  return again;
}

/// Encodes the snapshots without latents, or all, with the newest model.
Result<OrSkipped<EntityReport>> with_newest_model(const EntityWork& work,
                                                  const PlannedEntity& planned,
                                                  const Allotment& time) {
  using Done = OrSkipped<EntityReport>;
  const ltm::ModelInfo* newest = work.reader.manifest().newest_model(work.entity);
  if (newest == nullptr)
    return Done(Skipped{fmt::format("{}: has no model yet", work.entity.to_string())});
  ENGRAM_ASSIGN_OR_RETURN(const auto model,
                          encoders::read_model(work.reader.path() / newest->file));
  std::vector<ltm::SnapshotEntry> entries = planned.entries;
  if (!work.options.force)
    std::erase_if(entries,
                  [](const ltm::SnapshotEntry& entry) { return entry.latent.has_value(); });
  return encode_with_newest(work, model, entries, planned.representation, time, report_of(planned));
}

/// Publishes the cheaper choice: the new model with its latents, or more latents of the previous
/// model.
Result<EntityReport> publish(const EntityWork& work, MadeModel made, ComparedModels compared,
                             EntityReport report) {
  std::ranges::move(compared.notes, std::back_inserter(report.notes));
  report.choice = compared.choice;
  report.training = std::move(made.fitted.training);
  report.encoding_seconds = made.encoding_seconds;
  if (compared.previous) report.encoding_seconds += compared.previous->seconds;
  if (compared.choice.keeps_previous()) {
    const EncodedEntity& kept = *compared.previous;
    tell(kept, kept.snapshots, report);
    report.model_bytes = work.reader.manifest().newest_model(work.entity)->bytes;
    if (kept.latents.empty()) return report;
    ENGRAM_RETURN_IF_ERROR(publish_more_latents(work, kept.model_version, kept.latents));
    return report;
  }
  tell(made.encoded, made.wanted, report);
  report.is_model_new = true;
  report.model_bytes = made.file.bytes;
  ENGRAM_RETURN_IF_ERROR(publish_new_model(work, made.encoded.model_version, made.file,
                                           compared.choice, made.encoded.latents));
  return report;
}

/// Keeps what the searches for videos found out for the next night.
void learn_history(const EntityWork& work, const ChosenForm& form, NightHistory history) {
  history.learn(*form.representation.videos);
  if (history != NightHistory{}) write_history(work.reader.path(), work.entity, history);
}

/// Whether images are kept as video, and no model with networks is there that might be cheaper.
bool is_video_for_good(const EntityWork& work, const PlannedEntity& planned,
                       const ChosenForm& form) {
  return form.is_video_alone() && (work.options.representation.kind == Representation::kVideo ||
                                   work.reader.manifest().newest_model(work.entity) == nullptr ||
                                   model_of_more_video(work, planned, form) != nullptr);
}

/// Fits a new model, compares it with the previous one and publishes the cheaper choice.
Result<OrSkipped<EntityReport>> with_new_model(const EntityWork& work, const PlannedEntity& planned,
                                               const ChosenForm& form, const Allotment& time) {
  using Done = OrSkipped<EntityReport>;
  ENGRAM_ASSIGN_OR_RETURN(const TrainingSource source, find_training_source(work, planned));
  if (work.options.job.is_fresh) {
    remove_stale_checkpoints(work);
  } else {
    const std::array kept{checkpoint_of(work, source, form.train),
                          checkpoint_of(work, source, form.as_video_alone().train)};
    remove_stale_checkpoints(work, kept);
  }
  ENGRAM_ASSIGN_OR_RETURN(auto first, make(work, planned, source, form, time));
  if (auto* skipped = std::get_if<Skipped>(&first)) return Done(std::move(*skipped));
  EntityReport report = report_of(planned);
  report.notes = form.notes;
  NightHistory history = form.history;
  ENGRAM_ASSIGN_OR_RETURN(
      auto chosen, or_video_alone(work, planned, source, form, time,
                                  std::move(std::get<MadeModel>(first)), history, report.notes));
  if (auto* skipped = std::get_if<Skipped>(&chosen)) return Done(std::move(*skipped));
  auto& made = std::get<MadeModel>(chosen);
  ENGRAM_ASSIGN_OR_RETURN(
      ComparedModels compared,
      compare_models(work, planned, form, made.encoded, made.file.bytes, limits_of(time)));
  ENGRAM_ASSIGN_OR_RETURN(EntityReport done,
                          publish(work, std::move(made), std::move(compared), std::move(report)));
  learn_history(work, form, std::move(history));
  return Done(std::move(done));
}

Result<OrSkipped<EntityReport>> as_chosen(const EntityWork& work, const PlannedEntity& planned,
                                          const ChosenForm& form, const Allotment& time) {
  if (!is_video_for_good(work, planned, form)) return with_new_model(work, planned, form, time);
  auto done = keep_as_video(work, planned, form, time);
  if (done.ok()) learn_history(work, form, form.history);
  return done;
}

}  // namespace

EntityReport skip_entity(const EntityWork& work, const PlannedEntity& planned,
                         const Skipped& skipped) {
  if (!skipped.is_late) remove_stale_checkpoints(work);
  EntityReport report = report_of(planned);
  report.skipped_reason = skipped.reason;
  return report;
}

Result<EntityReport> consolidate_entity(const EntityWork& work, const PlannedEntity& planned,
                                        const std::optional<ChosenForm>& form,
                                        const Allotment& time) {
  if (planned.is_skipped()) return skip_entity(work, planned, {planned.plan.skipped_reason});
  const auto start = std::chrono::steady_clock::now();
  const auto stage = work.stage(Stage::kOther);
  Result<OrSkipped<EntityReport>> done = [&]() -> Result<OrSkipped<EntityReport>> {
    if (work.options.reuses_models) return with_newest_model(work, planned, time);
    if (form) return as_chosen(work, planned, *form, time);
    ENGRAM_ASSIGN_OR_RETURN(const ChosenForm chosen, choose_form(work, planned));
    return as_chosen(work, planned, chosen, time);
  }();
  ENGRAM_RETURN_IF_ERROR(done.status());
  const auto* skipped = std::get_if<Skipped>(&*done);
  EntityReport report = skipped != nullptr ? skip_entity(work, planned, *skipped)
                                           : std::move(std::get<EntityReport>(*done));
  if (skipped == nullptr) remove_stale_checkpoints(work);
  report.seconds = to_seconds(std::chrono::steady_clock::now() - start);
  return report;
}

}  // namespace engram::training
