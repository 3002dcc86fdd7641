// SPDX-License-Identifier: Apache-2.0
#include "training/fade/learned_from.h"

#include <algorithm>

#include "encoders/latent_block.h"
#include "encoders/packed_video.h"

namespace engram::training {

namespace {

bool touches(const std::vector<encoders::TimeSpan>& spans, const TimeSet& gone) {
  return std::ranges::any_of(spans, [&gone](const encoders::TimeSpan& span) {
    return gone.has_any_in(span.first, span.last);
  });
}

const TimeSet& times_of(const ltm::ForgetSet& gone, const ltm::MemoryId& entity) {
  static const TimeSet kNone;
  const auto found = gone.find(entity);
  return found == gone.end() ? kNone : found->second;
}

}  // namespace

bool knows_no_content(const encoders::DeepModel& model) {
  return model.autoencoder->images.empty() && model.plan.number_count() == 0 && !model.condition;
}

Learned learned_from(const encoders::DeepModel& model, const ltm::MemoryId& entity,
                     const ltm::ForgetSet& gone) {
  Learned learned;
  const TimeSet& own = times_of(gone, entity);
  const auto& origin = model.provenance;
  const auto is_touched = [&origin](const TimeSet& times) {
    return touches(origin.autoencoder_spans, times) || touches(origin.dynamics_spans, times);
  };
  if (!knows_no_content(model)) {
    learned.is_tainted = is_touched(own);
    if (model.condition)
      if (const auto other = ltm::MemoryId::parse(model.condition->entity); other.ok())
        learned.is_tainted = learned.is_tainted || is_touched(times_of(gone, *other));
  }
  for (const auto& references : model.codec.chain.references)
    for (const encoders::VideoReference& reference : references)
      if (own.contains(time_from_ns(reference.time))) learned.references.insert(reference.hash());
  return learned;
}

int64_t forgotten_for(const encoders::DeepModel& model, const ltm::MemoryId& entity,
                      const ltm::Manifest& manifest) {
  int64_t forgotten = 0;
  for (const auto& [id, sums] : manifest.forgotten)
    if (id == entity || (model.condition && id.to_string() == model.condition->entity))
      forgotten += static_cast<int64_t>(sums.snapshots);
  return forgotten;
}

Result<Learned> learned_from_forgotten(const encoders::DeepModel& model,
                                       const ltm::MemoryId& entity, ltm::StoreReader& reader) {
  Learned learned;
  // A file that does not tell when it was made may have learned from the first that went. One that
  // tells more than went was made by an erasure that did not come to its end.
  const int64_t known = std::max<int64_t>(model.provenance.forgotten, 0);
  learned.is_tainted =
      !knows_no_content(model) && forgotten_for(model, entity, reader.manifest()) != known;
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader.timeline(entity));
  for (const auto& references : model.codec.chain.references) {
    for (const encoders::VideoReference& reference : references) {
      const Time time = time_from_ns(reference.time);
      ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(time));
      if (!entry || entry->time != time) learned.references.insert(reference.hash());
    }
  }
  return learned;
}

Result<bool> begins_from(const ltm::Latent& latent, size_t images,
                         const std::set<uint64_t>& references) {
  if (references.empty() || images == 0) return false;
  ENGRAM_ASSIGN_OR_RETURN(
      const auto block, encoders::describe_block(latent.code.bytes(), latent.place.count, images));
  for (const auto& chain : block.chains) {
    for (const encoders::ImageCode& image : chain) {
      if (image.form != encoders::ImageForm::kPackedAv1) continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto reference, encoders::reference_of_video(image.code));
      if (reference && references.contains(*reference)) return true;
    }
  }
  return false;
}

}  // namespace engram::training
