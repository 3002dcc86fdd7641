// SPDX-License-Identifier: Apache-2.0
#include "training/measure/code_length.h"

#include <algorithm>
#include <numeric>

#include "encoders/deep_model_file.h"

namespace engram::training {

using encoders::ImageForm;

namespace {

constexpr uint64_t kMaxRows = 320;

/// Whether all images of all rows are latents.
bool has_latents_alone(const encoders::LatentRows& rows) {
  return !rows.images.empty() && std::ranges::all_of(rows.images, [](const auto& image) {
    return image.form == ImageForm::kLatents;
  });
}

/// Adds one chain that holds latents alone.
void add_chain(const encoders::DeepModel& model, const encoders::LatentRows& rows, size_t count,
               CodeLength& sum) {
  for (size_t i = 0; i < rows.images.size(); ++i) {
    const encoders::LatentSequenceCodec& codec = model.codec.chain.images[i];
    const std::vector<double> bits = codec.cost_bits(rows.images[i].latents);
    const double all = std::accumulate(bits.begin(), bits.end(), 0.0);
    sum.coded_bytes += static_cast<double>(codec.encode(rows.images[i].latents).size());
    sum.ideal_bytes += all / 8;
    sum.later_bytes += (all - bits.front()) / 8;
  }
  sum.rows += count;
  sum.later_rows += count - 1;
}

}  // namespace

Result<CodeLength> measure_code_length(ltm::StoreReader& reader, const ltm::ModelInfo& info,
                                       const std::vector<ltm::SnapshotEntry>& index) {
  ENGRAM_ASSIGN_OR_RETURN(const auto model, encoders::read_model(reader.path() / info.file));
  const size_t rows_of_chain = model->codec.chain_rows;
  CodeLength sum;
  sum.prior_row_bytes = model->provenance.prior_bytes;
  for (const ltm::SnapshotEntry& entry : index) {
    if (!entry.latent || sum.rows >= kMaxRows) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, reader.read_latent(info.entity, entry));
    if (snapshot.model_version != info.version) continue;
    for (const ltm::LatentInstance& instance : snapshot.instances) {
      const auto [row, count] = instance.latent.place;
      if (row != 0) continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto chains,
                              model->codec.decode_all(instance.latent.code.bytes(), count));
      for (size_t i = 0; i < chains.size(); ++i)
        if (has_latents_alone(chains[i]))
          add_chain(*model, chains[i], std::min(rows_of_chain, count - i * rows_of_chain), sum);
    }
  }
  return sum;
}

}  // namespace engram::training
