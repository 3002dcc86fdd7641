// SPDX-License-Identifier: Apache-2.0
#include "training/night/previous_model.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "encoders/deep_model_file.h"
#include "ltm/idf/binary.h"
#include "training/night/entity_references.h"
#include "training/night/model_of_latents.h"
#include "training/quality/psnr.h"

namespace engram::training {

using Model = std::shared_ptr<encoders::DeepModel>;

double bytes_of(const ltm::LatentSnapshot& snapshot) {
  double bytes = 0;
  for (const ltm::LatentInstance& instance : snapshot.instances) {
    const ltm::Latent& latent = instance.latent;
    bytes += static_cast<double>(latent.code.size()) / latent.place.count;
    if (!latent.remainder.empty())
      bytes += static_cast<double>(idf::encoded_size(idf::Data(latent.remainder)));
  }
  return bytes;
}

std::string not_compared(const ltm::ModelInfo& newest, std::string_view why) {
  return fmt::format("v{} was not compared with: {}", newest.version, why);
}

Model usable_model(const EntityWork& work, const PlannedEntity& planned, const ChosenForm& form,
                   const ltm::ModelInfo& newest, std::vector<std::string>& notes) {
  auto model = encoders::read_model(work.reader.path() / newest.file);
  const auto unusable = [&](std::string_view why) {
    notes.push_back(not_compared(newest, why));
    return Model();
  };
  if (!model.ok()) return unusable(model.status().message());
  if (!((*model)->plan.layout() == planned.layout)) return unusable("it has another layout");
  if ((*model)->provenance.number_bound != form.train.number_bound)
    return unusable("it keeps numbers within another bound");
  return *std::move(model);
}

namespace {

/// Whether all pictures from which the model's videos begin are still remembered. A store that
/// cannot tell is no reason for a new model.
bool are_references_remembered(const EntityWork& work, const encoders::DeepModel& model) {
  for (const auto& references : model.codec.chain.references)
    for (const encoders::VideoReference& reference : references)
      if (!is_remembered(work, reference).value_or(true)) return false;
  return true;
}

}  // namespace

Model model_of_more_video(const EntityWork& work, const PlannedEntity& planned,
                          const ChosenForm& form) {
  // Snapshots below the bound are encoded again, which is known of single images alone. A model of
  // a much higher bound takes more bytes than were asked for.
  constexpr double kMaxSpareDb = 1.0;
  const ltm::ModelInfo* newest = work.reader.manifest().newest_model(work.entity);
  const bool is_told_to = work.options.starts_anew || work.options.force;
  if (newest == nullptr || is_told_to || !planned.has_images_alone()) return nullptr;
  std::vector<std::string> unused;
  Model model = usable_model(work, planned, form, *newest, unused);
  if (!model || !model->autoencoder->images.empty()) return nullptr;
  const double spare_db = model->provenance.forms.bound_db - planned.representation.bound_db;
  if (spare_db > kMaxSpareDb || (spare_db < 0 && model->plan.images().size() > 1)) return nullptr;
  if (static_cast<int>(model->codec.chain_rows) != form.train.chain_rows) return nullptr;
  if (!are_references_remembered(work, *model)) return nullptr;
  return model;
}

Result<std::optional<double>> known_bytes(const EntityWork& work, const PlannedEntity& planned,
                                          const encoders::DeepModel& newest,
                                          const ltm::SnapshotEntry& entry) {
  using Bytes = std::optional<double>;
  if (version_of_latents(work, entry) != planned.plan.newest_version) return Bytes();
  const double bound_db = planned.representation.bound_db;
  // The measured error is the mean over all images, which does not show that each one keeps the
  // bound.
  if (newest.plan.images().size() > 1 && newest.provenance.forms.bound_db < bound_db)
    return Bytes();
  ENGRAM_ASSIGN_OR_RETURN(const auto latents, work.reader.read_latent(work.entity, entry));
  for (const ltm::LatentInstance& instance : latents.instances) {
    const double mse = instance.quality.error.image_mse;
    if (!std::isnan(mse) && psnr_db(mse) < bound_db) return Bytes();
  }
  return Bytes(bytes_of(latents));
}

}  // namespace engram::training
