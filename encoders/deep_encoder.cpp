// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "encoders/deep_model.h"

namespace engram::encoders {

namespace {

class DeepEncoder : public ltm::Encoder {
 public:
  explicit DeepEncoder(std::shared_ptr<DeepModel> model) : model_(std::move(model)) {}

  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values) override {
    return guarded("encode", [&]() -> Result<std::vector<ltm::Latent>> {
      std::vector<ltm::Latent> latents;
      for (; !values.empty();
           values = values.subspan(std::min(model_->block_rows(), values.size()))) {
        ENGRAM_ASSIGN_OR_RETURN(
            auto block,
            model_->encode(values.first(std::min(model_->block_rows(), values.size()))));
        std::ranges::move(block, std::back_inserter(latents));
      }
      return latents;
    });
  }

  Result<std::vector<idf::Data>> decode(std::span<const ltm::Latent> latents) override {
    return guarded("decode", [&]() -> Result<std::vector<idf::Data>> {
      std::vector<idf::Data> values;
      for (const ltm::Latent& latent : latents) {
        ENGRAM_RETURN_IF_ERROR(block_.reach(model_->codec, latent));
        ENGRAM_ASSIGN_OR_RETURN(idf::Data value,
                                model_->decode(block_.rows(), block_.row(), latent.remainder));
        values.push_back(std::move(value));
      }
      return values;
    });
  }

  Result<std::vector<std::vector<float>>> global_codes(
      std::span<const ltm::Latent> latents) override {
    return guarded("global codes", [&]() -> Result<std::vector<std::vector<float>>> {
      std::vector<std::vector<float>> codes;
      for (const ltm::Latent& latent : latents) {
        ENGRAM_RETURN_IF_ERROR(block_.reach(model_->codec, latent));
        ENGRAM_ASSIGN_OR_RETURN(
            codes.emplace_back(),
            model_->global_code_of(block_.rows(), block_.row(), latent.remainder));
      }
      return codes;
    });
  }

  Result<std::vector<float>> global_code(const idf::Data& value) override {
    return guarded("global code", [&] { return model_->global_code_of(value); });
  }

 private:
  /// Keeps the last decoded block and the decoded rows of its last chain.
  class Block {
   public:
    /// Decodes up to the row of `latent`. The first request for a chain decodes no more rows than
    /// it needs. A second one decodes the whole chain, because more requests are then likely.
    Status reach(const LatentBlockCodec& codec, const ltm::Latent& latent) {
      const auto [index, count] = latent.place;
      if (index >= count)
        return data_loss("latent: found place {} in a block of {} rows", index, count);
      ENGRAM_RETURN_IF_ERROR(open(codec, latent));
      const size_t chain = index / open_.chain_rows;
      row_ = index % open_.chain_rows;
      const bool is_known = chain == chain_;
      if (is_known && row_ < known_) return {};
      const size_t wanted = is_known ? open_.rows_of(chain) : row_ + 1;
      chain_.reset();
      known_ = 0;
      ENGRAM_ASSIGN_OR_RETURN(rows_, codec.decode(open_, chain, wanted));
      chain_ = chain;
      known_ = wanted;
      return {};
    }

    [[nodiscard]] const LatentRows& rows() const { return rows_; }
    /// Index of the row of the last reach().
    [[nodiscard]] size_t row() const { return row_; }

   private:
    Status open(const LatentBlockCodec& codec, const ltm::Latent& latent) {
      const uint32_t count = latent.place.count;
      if (count == open_.count && std::ranges::equal(bytes_.bytes(), latent.code.bytes()))
        return {};
      open_ = {};
      chain_.reset();
      known_ = 0;
      ENGRAM_ASSIGN_OR_RETURN(OpenBlock opened, codec.open(latent.code.bytes(), count));
      bytes_ = latent.code;
      open_ = std::move(opened);
      return {};
    }

    Buffer bytes_;  ///< The bytes that `open_` refers to.
    OpenBlock open_;
    std::optional<size_t> chain_;
    size_t known_ = 0;  ///< Decoded rows in `rows_`.
    size_t row_ = 0;
    LatentRows rows_;
  };

  std::shared_ptr<DeepModel> model_;
  Block block_;
};

}  // namespace

std::unique_ptr<ltm::Encoder> make_encoder(std::shared_ptr<DeepModel> model) {
  return std::make_unique<DeepEncoder>(std::move(model));
}

}  // namespace engram::encoders
