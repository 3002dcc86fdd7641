// SPDX-License-Identifier: Apache-2.0
#include "training/measure/stored_snapshots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "encoders/latent_block.h"
#include "encoders/model_file.h"
#include "ltm/idf/binary.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

KeptForm form_of(const encoders::ImageCode& code, bool has_residual) {
  if (code.form == encoders::ImageForm::kFfv1) return KeptForm::kLossless;
  if (code.form == encoders::ImageForm::kGist) return KeptForm::kGist;
  if (code.form != encoders::ImageForm::kLatents) return KeptForm::kVideo;
  if (has_residual) return KeptForm::kResidual;
  return code.is_refined ? KeptForm::kRefined : KeptForm::kLatents;
}

/// Size of all images of a chain, including residuals.
double bytes_of(const std::vector<encoders::ImageCode>& chain) {
  uint64_t bytes = 0;
  for (const encoders::ImageCode& code : chain) {
    bytes += code.bytes;
    for (const auto& residual : code.residual_bytes) bytes += residual.value_or(0);
  }
  return static_cast<double>(bytes);
}

/// Reads the heads of blocks of latents.
class Descriptions {
 public:
  Descriptions(ltm::StoreReader& reader, const ltm::MemoryId& entity)
      : reader_(reader), entity_(entity) {}

  Status add(const ltm::Latent& latent, int version, StoredSnapshot& snapshot) {
    ENGRAM_ASSIGN_OR_RETURN(const auto* members, members_of(version));
    const auto [index, count] = latent.place;
    ENGRAM_ASSIGN_OR_RETURN(const auto block,
                            encoders::describe_block(latent.code.bytes(), count, members->size()));
    const auto& codes = block.chains[index / block.chain_rows];
    const size_t row = index % block.chain_rows;
    const size_t first = index - row;
    const auto rows = static_cast<double>(std::min<size_t>(block.chain_rows, count - first));
    // The bytes that are not images of a chain count evenly for all rows.
    double rest = static_cast<double>(latent.code.size());
    for (const auto& chain : block.chains) rest -= bytes_of(chain);
    snapshot.bytes += rest / count;
    for (size_t i = 0; i < codes.size(); ++i) {
      const encoders::ImageCode& code = codes[i];
      std::optional<uint64_t> residual;
      if (!code.residual_bytes.empty()) residual = code.residual_bytes[row];
      StoredImage& image = snapshot.images.emplace_back();
      image.member = (*members)[i];
      image.form = form_of(code, residual.has_value());
      image.residual_bytes = residual.value_or(0);
      const double own =
          static_cast<double>(code.bytes) / rows + static_cast<double>(residual.value_or(0));
      image.bytes = own + static_cast<double>(block.background_bytes[i]) / count;
      snapshot.bytes += own;
    }
    if (!latent.remainder.empty())
      snapshot.bytes += static_cast<double>(idf::encoded_size(idf::Data(latent.remainder)));
    return {};
  }

 private:
  /// Paths of the image members in blocks of a model.
  Result<const std::vector<std::string>*> members_of(int version) {
    if (const auto known = members_.find(version); known != members_.end()) return &known->second;
    const auto& models = reader_.manifest().models;
    const auto info = std::ranges::find_if(models, [&](const ltm::ModelInfo& model) {
      return model.entity == entity_ && model.version == version;
    });
    if (info == models.end())
      return data_loss("{}: latents of model v{}, which is missing", entity_.to_string(), version);
    ENGRAM_ASSIGN_OR_RETURN(const idf::Layout layout,
                            encoders::read_layout(reader_.path() / info->file));
    std::vector<std::string> members;
    for (const idf::TensorMember& member : layout.members())
      if (member.kind == idf::MemberKind::kImage) members.push_back(member.path);
    return &members_.emplace(version, std::move(members)).first->second;
  }

  ltm::StoreReader& reader_;
  const ltm::MemoryId& entity_;
  std::map<int, std::vector<std::string>> members_;  ///< By version.
};

}  // namespace

std::string_view to_string(KeptForm form) {
  constexpr std::array<std::string_view, 6> kNames{"latents", "refined",  "residual",
                                                   "video",   "lossless", "gist"};
  return kNames[static_cast<size_t>(form)];
}

Status list_stored_snapshots(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                             const std::function<Status(const StoredSnapshot&)>& sink) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, reader.index(entity));
  Descriptions descriptions(reader, entity);
  for (const ltm::SnapshotEntry& entry : *index) {
    if (!entry.latent) continue;
    ENGRAM_ASSIGN_OR_RETURN(const ltm::LatentSnapshot latents, reader.read_latent(entity, entry));
    StoredSnapshot snapshot{latents.time, latents.model_version, {}, 0, 0, 0};
    double mse = 0;
    double number_mse = 0;
    for (const ltm::LatentInstance& instance : latents.instances) {
      ENGRAM_RETURN_IF_ERROR(descriptions.add(instance.latent, latents.model_version, snapshot));
      const auto count = static_cast<double>(latents.instances.size());
      mse += instance.quality.error.image_mse / count;
      number_mse += instance.quality.error.number_mse / count;
    }
    snapshot.psnr_db =
        snapshot.images.empty() ? std::numeric_limits<double>::quiet_NaN() : psnr_db(mse);
    snapshot.rmse = std::sqrt(number_mse);
    ENGRAM_RETURN_IF_ERROR(sink(snapshot));
  }
  return {};
}

}  // namespace engram::training
