// SPDX-License-Identifier: Apache-2.0
#include "training/night/stored_videos.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "encoders/deep_model.h"
#include "encoders/model_file.h"
#include "ltm/core/log.h"

namespace engram::training {

namespace {

using Images = std::vector<idf::NdArray>;

/// Videos that were made for a bound that is higher by more are searched for again. A bound that
/// follows the noise of a camera differs a little from night to night. Unit: dB.
constexpr double kMaxSpareDb = 0.5;

/// The bound that a stored model's images were made for; infinite where nobody knows it.
double bound_of(ltm::StoreReader& reader, const ltm::MemoryId& entity, int version) {
  for (const ltm::ModelInfo& model : reader.manifest().models) {
    if (model.entity != entity || model.version != version) continue;
    const auto from = encoders::read_provenance(reader.path() / model.file);
    if (from.ok()) return from->forms.bound_db;
  }
  return std::numeric_limits<double>::infinity();
}

/// The images of a member in rows of a chain.
Result<Images> images_of(std::span<const idf::Data> values, const encoders::TensorPlan& plan,
                         size_t image) {
  Images images;
  for (const idf::Data& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(idf::SplitValue split, plan.split(value));
    images.push_back(std::move(split.tensors[plan.images()[image].member]));
  }
  return images;
}

Status add_chain(const std::vector<encoders::ImageCode>& codes, std::span<const idf::Data> values,
                 const encoders::TensorPlan& plan, EntityVideos& videos) {
  for (size_t i = 0; i < codes.size(); ++i) {
    // A gist keeps no bound, so it is no video to use again.
    if (codes[i].form == encoders::ImageForm::kLatents ||
        codes[i].form == encoders::ImageForm::kGist)
      continue;
    ENGRAM_ASSIGN_OR_RETURN(const Images images, images_of(values, plan, i));
    ENGRAM_RETURN_IF_ERROR(
        videos.add_stored(i, images, codes[i].form, codes[i].code, codes[i].residual));
  }
  return {};
}

}  // namespace

void add_stored_videos(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                       std::span<const ltm::SnapshotEntry> entries,
                       std::span<const idf::Data> values, const encoders::DeepModel& model,
                       EntityVideos& videos) {
  if (entries.empty() || !entries.front().latent || videos.members() == 0) return;
  const auto unused = [&](const Status& why) {
    log::debug("{}: stored videos are not used again: {}", entity.to_string(), why.message());
  };
  const auto stored = reader.read_latent(entity, entries.front());
  if (!stored.ok()) return unused(stored.status());
  if (stored->instances.empty()) return;
  const ltm::Latent& latent = stored->instances.front().latent;
  if (latent.place.index != 0) return;
  if (bound_of(reader, entity, stored->model_version) >
      videos.search_of(0).options().bound_db + kMaxSpareDb)
    return;
  const auto block =
      encoders::describe_block(latent.code.bytes(), latent.place.count, videos.members());
  if (!block.ok()) return unused(block.status());
  if (block->chain_rows != model.codec.chain_rows) return;
  for (size_t chain = 0; chain < block->chains.size(); ++chain) {
    const size_t first = chain * block->chain_rows;
    const size_t end = std::min<size_t>(first + block->chain_rows, latent.place.count);
    // The last chain is shorter; where snapshots came after it, it is another one now.
    if (end > values.size() || (end - first < block->chain_rows && end < values.size())) break;
    if (const Status added =
            add_chain(block->chains[chain], values.subspan(first, end - first), model.plan, videos);
        !added.ok())
      return unused(added);
  }
}

}  // namespace engram::training
