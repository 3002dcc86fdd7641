// SPDX-License-Identifier: Apache-2.0
#include "training/night/video_alone.h"

#include <fmt/format.h>

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "encoders/deep_model_file.h"
#include "ltm/store/publish.h"
#include "training/night/encode_groups.h"
#include "training/night/entity_report.h"
#include "training/night/fit_entity.h"
#include "training/night/previous_model.h"
#include "training/night/publish_entity.h"

namespace engram::training {

namespace {

using Model = std::shared_ptr<encoders::DeepModel>;

/// Publishes a new model with the first group of latents, and then more of them.
class ModelPublisher {
 public:
  /// `work` must outlive this object.
  ModelPublisher(const EntityWork& work, Model model) : work_(work), model_(std::move(model)) {}

  [[nodiscard]] int version() const { return version_; }
  /// Bytes of the model; 0 before it is published.
  [[nodiscard]] uint64_t model_bytes() const { return model_bytes_; }

  Status publish(const std::vector<ltm::LatentSnapshot>& latents, const KeptQuality& quality) {
    if (model_bytes_ > 0) return publish_more_latents(work_, version_, latents);
    // The model tells the forms of the first group. The others are like it.
    model_->provenance.forms = quality.forms;
    ENGRAM_ASSIGN_OR_RETURN(const ModelFile file, write_model_file(work_, *model_));
    ENGRAM_RETURN_IF_ERROR(publish_new_model(work_, version_, file, {}, latents));
    model_bytes_ = file.bytes;
    return {};
  }

 private:
  const EntityWork& work_;
  Model model_;
  int version_ = ltm::next_model_version(work_.reader.manifest(), work_.entity);
  uint64_t model_bytes_ = 0;
};

/// Encodes what has no latents of the newest model.
Result<OrSkipped<EntityReport>> go_on(const EntityWork& work, const PlannedEntity& planned,
                                      const Model& model, const ChosenForm& form,
                                      const Allotment& time) {
  std::vector<ltm::SnapshotEntry> rest;
  for (const ltm::SnapshotEntry& entry : planned.entries) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, known_bytes(work, planned, *model, entry));
    if (!bytes) rest.push_back(entry);
  }
  EntityReport report = report_of(planned);
  report.notes = form.notes;
  report.notes.push_back(
      fmt::format("v{} goes on: it has no networks, so a new model would be no better",
                  planned.plan.newest_version));
  return encode_with_newest(work, model, rest, form.representation, time, std::move(report));
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
  EntityReport report = report_of(planned);
  report.notes = form.notes;
  ModelPublisher publisher(work, made.model);
  const auto publish = [&](const auto& latents, const KeptQuality& quality) {
    return publisher.publish(latents, quality);
  };
  ENGRAM_ASSIGN_OR_RETURN(
      Done done,
      encode_in_groups(
          work, {made.model, publisher.version(), planned.entries, form.representation, publish},
          time, std::move(report)));
  if (auto* told = std::get_if<EntityReport>(&done)) {
    told->is_model_new = true;
    told->model_bytes = publisher.model_bytes();
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
