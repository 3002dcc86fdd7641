// SPDX-License-Identifier: Apache-2.0
#include "training/night/video_alone.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "encoders/deep_model_file.h"
#include "ltm/store/publish.h"
#include "training/night/encode_entity.h"
#include "training/night/entity_report.h"
#include "training/night/fit_entity.h"
#include "training/night/previous_model.h"
#include "training/night/publish_entity.h"

namespace engram::training {

namespace {

using Model = std::shared_ptr<encoders::DeepModel>;

/// Publishes groups of latents, and the model with the first one unless the store has it.
class GroupPublisher {
 public:
  /// All references must outlive this object.
  GroupPublisher(const EntityWork& work, const PlannedEntity& planned, Model model, int version,
                 bool is_published)
      : work_(work),
        planned_(planned),
        model_(std::move(model)),
        version_(version),
        is_published_(is_published) {}

  Status publish(const std::vector<ltm::LatentSnapshot>& latents, const KeptQuality& quality) {
    if (latents.empty()) return {};
    if (is_published_) return publish_more_latents(work_, version_, latents);
    // The model tells the forms of the first group. The others are like it.
    model_->provenance.forms = quality.forms;
    ENGRAM_ASSIGN_OR_RETURN(const ModelFile file, write_model_file(work_, planned_, *model_));
    ENGRAM_RETURN_IF_ERROR(publish_new_model(work_, version_, file, {}, latents));
    model_bytes_ = file.bytes;
    is_published_ = true;
    return {};
  }

  /// Bytes of the model that was published; nothing if the store had it.
  [[nodiscard]] std::optional<uint64_t> model_bytes() const { return model_bytes_; }

 private:
  const EntityWork& work_;
  const PlannedEntity& planned_;
  Model model_;
  int version_;
  bool is_published_;
  std::optional<uint64_t> model_bytes_;
};

/// Encodes and publishes, and tells what was done.
Result<OrSkipped<EntityReport>> encode_in_groups(const EntityWork& work, const Model& model,
                                                 int version,
                                                 std::span<const ltm::SnapshotEntry> entries,
                                                 const ChosenForm& form, const Allotment& time,
                                                 GroupPublisher& publisher, EntityReport report) {
  using Done = OrSkipped<EntityReport>;
  EncodingLimits limits;
  limits.end = time.encoded_end;
  limits.seconds_per_snapshot = time.seconds_per_snapshot;
  limits.publish_interval = work.options.job.publish_interval;
  limits.publish = [&](const auto& latents, const KeptQuality& quality) {
    return publisher.publish(latents, quality);
  };
  ENGRAM_ASSIGN_OR_RETURN(auto encoded, or_skipped(encode_entity(work, model, version, entries,
                                                                 form.representation, limits),
                                                   work.pace));
  if (auto* skipped = std::get_if<Skipped>(&encoded)) return Done(std::move(*skipped));
  const auto& done = std::get<EncodedEntity>(encoded);
  if (done.snapshots == 0 && !entries.empty()) return Done(nothing_encoded());
  ENGRAM_RETURN_IF_ERROR(publisher.publish(done.latents, done.quality));
  tell(done, entries.size(), report);
  report.encoding_seconds = done.seconds;
  return Done(std::move(report));
}

/// Encodes what has no latents of the newest model.
Result<OrSkipped<EntityReport>> go_on(const EntityWork& work, const PlannedEntity& planned,
                                      const Model& model, const ChosenForm& form,
                                      const Allotment& time) {
  const ltm::ModelInfo& newest = *work.reader.manifest().newest_model(work.entity);
  std::vector<ltm::SnapshotEntry> rest;
  for (const ltm::SnapshotEntry& entry : planned.entries) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, known_bytes(work, planned, *model, entry));
    if (!bytes) rest.push_back(entry);
  }
  EntityReport report = report_of(planned);
  report.notes = form.notes;
  report.notes.push_back(fmt::format(
      "v{} goes on: it has no networks, so a new model would be no better", newest.version));
  report.model_bytes = newest.bytes;
  GroupPublisher publisher(work, planned, model, newest.version, true);
  return encode_in_groups(work, model, newest.version, rest, form, time, publisher,
                          std::move(report));
}

/// Makes a model without networks and encodes everything.
Result<OrSkipped<EntityReport>> begin(const EntityWork& work, const PlannedEntity& planned,
                                      const ChosenForm& form, const Allotment& time) {
  using Done = OrSkipped<EntityReport>;
  ENGRAM_ASSIGN_OR_RETURN(const TrainingSource source, find_training_source(work, planned));
  ENGRAM_ASSIGN_OR_RETURN(auto fitted,
                          or_skipped(fit_entity(work, planned, source, form, time), work.pace));
  if (auto* skipped = std::get_if<Skipped>(&fitted)) return Done(std::move(*skipped));
  auto& made = std::get<FittedModel>(fitted);
  const int version = ltm::next_model_version(work.reader.manifest(), work.entity);
  EntityReport report = report_of(planned);
  report.notes = form.notes;
  GroupPublisher publisher(work, planned, made.model, version, false);
  ENGRAM_ASSIGN_OR_RETURN(Done done, encode_in_groups(work, made.model, version, planned.entries,
                                                      form, time, publisher, std::move(report)));
  if (auto* told = std::get_if<EntityReport>(&done)) {
    told->is_model_new = true;
    told->model_bytes = publisher.model_bytes().value_or(0);
    told->training = std::move(made.training);
  }
  return done;
}

}  // namespace

Result<OrSkipped<EntityReport>> keep_as_video(const EntityWork& work, const PlannedEntity& planned,
                                              const ChosenForm& form, const Allotment& time) {
  if (const Model model = model_of_more_video(work, planned, form))
    return go_on(work, planned, model, form, time);
  return begin(work, planned, form, time);
}

}  // namespace engram::training
