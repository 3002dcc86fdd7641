// SPDX-License-Identifier: Apache-2.0
#include "encoders/open_model.h"

#include <algorithm>

#include "encoders/deep_model_file.h"
#include "encoders/stored_tensors.h"

namespace engram::encoders {

struct OpenModel::State {
  std::shared_ptr<DeepModel> model;
  std::vector<LatentMember> images;
  std::unique_ptr<ltm::Predictor> predictor;

  [[nodiscard]] bool has_networks() const { return !model->autoencoder->images.empty(); }
  [[nodiscard]] const std::string& path_of(size_t image) const {
    return model->plan.layout().members()[model->plan.images()[image].member].path;
  }

  [[nodiscard]] LatentArrays no_arrays() const;
  Status check(const LatentArrays& latents) const;
  /// Adds row `row` of a chain.
  void add_row(const LatentRows& rows, size_t row, LatentArrays& arrays) const;
};

LatentArrays OpenModel::State::no_arrays() const {
  LatentArrays arrays;
  arrays.images.resize(images.size());
  arrays.is_latent.resize(images.size());
  arrays.own.resize(images.size());
  return arrays;
}

Status OpenModel::State::check(const LatentArrays& latents) const {
  const size_t count = latents.scenes.size();
  if (!model->plan.images().empty() && !has_networks())
    return failed_precondition(
        "model of '{}': has no networks for images: they are kept as video or without loss",
        model->provenance.entity);
  if (latents.images.size() != images.size())
    return invalid_argument("latents: found {} images, needs {}", latents.images.size(),
                            images.size());
  for (size_t i = 0; i < images.size(); ++i)
    if (latents.images[i].size() != count * images[i].count())
      return invalid_argument("latents of '{}': found {} integers, needs {} for {} values",
                              images[i].path, latents.images[i].size(), count * images[i].count(),
                              count);
  if (latents.numbers.size() != count * model->plan.number_count())
    return invalid_argument("latents: found {} numbers, needs {} for {} values",
                            latents.numbers.size(), count * model->plan.number_count(), count);
  if (latents.remainders.size() != count)
    return invalid_argument("latents: found {} remainders, needs {}", latents.remainders.size(),
                            count);
  for (const uint32_t scene : latents.scenes)
    if (scene >= model->codec.scenes)
      return invalid_argument("latents: found scene {}, needs one below {}", scene,
                              model->codec.scenes);
  return {};
}

void OpenModel::State::add_row(const LatentRows& rows, size_t row, LatentArrays& arrays) const {
  arrays.scenes.push_back(rows.scene);
  for (size_t i = 0; i < images.size(); ++i) {
    const bool is_latent = rows.images[i].form == ImageForm::kLatents;
    arrays.is_latent[i].push_back(is_latent);
    arrays.own[i].push_back(rows.own.empty() ? idf::NdArray() : rows.own[i].pixels);
    auto& all = arrays.images[i];
    const size_t each = images[i].count();
    if (is_latent) {
      const auto integers = std::span(rows.images[i].latents).subspan(row * each, each);
      all.insert(all.end(), integers.begin(), integers.end());
    } else {
      all.insert(all.end(), each, 0);
    }
  }
  const size_t count = model->plan.number_count();
  const auto numbers = std::span(rows.numbers).subspan(row * count, count);
  arrays.numbers.insert(arrays.numbers.end(), numbers.begin(), numbers.end());
}

OpenModel::OpenModel(std::unique_ptr<State> state) : state_(std::move(state)) {}
OpenModel::OpenModel(OpenModel&&) noexcept = default;
OpenModel::~OpenModel() = default;

Result<OpenModel> OpenModel::open(const std::filesystem::path& path) {
  auto state = std::make_unique<State>();
  ENGRAM_ASSIGN_OR_RETURN(state->model, read_model(path));
  state->predictor = make_predictor(state->model);
  if (state->has_networks())
    for (size_t i = 0; i < state->model->plan.images().size(); ++i) {
      const auto grids = state->model->autoencoder->shape.grids(i);
      state->images.push_back(
          {state->path_of(i), grids[0], grids[1], state->model->plan.images()[i].channels});
    }
  return OpenModel(std::move(state));
}

const Provenance& OpenModel::provenance() const {
  return state_->model->provenance;
}

const idf::Layout& OpenModel::layout() const {
  return state_->model->plan.layout();
}

const std::vector<LatentMember>& OpenModel::images() const {
  return state_->images;
}

std::vector<std::string> OpenModel::numbers() const {
  std::vector<std::string> paths;
  for (const NumberMember& member : state_->model->plan.numbers())
    paths.insert(paths.end(), member.count, layout().members()[member.member].path);
  return paths;
}

ltm::Predictor& OpenModel::predictor() {
  return *state_->predictor;
}

Result<LatentArrays> OpenModel::encode(std::span<const idf::Data> values) {
  return guarded("encode", [&]() -> Result<LatentArrays> {
    LatentArrays arrays = state_->no_arrays();
    if (values.empty()) return arrays;
    std::vector<idf::SplitValue> split;
    for (const idf::Data& value : values) {
      ENGRAM_ASSIGN_OR_RETURN(split.emplace_back(), state_->model->plan.split(value));
    }
    ENGRAM_ASSIGN_OR_RETURN(const LatentRows rows, state_->model->to_rows(split));
    for (size_t row = 0; row < split.size(); ++row) {
      state_->add_row(rows, row, arrays);
      arrays.remainders.push_back(std::move(split[row].remainder));
    }
    return arrays;
  });
}

Result<std::vector<idf::Data>> OpenModel::decode(const LatentArrays& latents) {
  ENGRAM_RETURN_IF_ERROR(state_->check(latents));
  return guarded("decode", [&]() -> Result<std::vector<idf::Data>> {
    std::vector<idf::Data> values;
    for (size_t at = 0; at < latents.scenes.size(); ++at) {
      LatentRows row;
      row.scene = latents.scenes[at];
      for (size_t i = 0; i < latents.images.size(); ++i) {
        const size_t each = state_->images[i].count();
        const auto integers = std::span(latents.images[i]).subspan(at * each, each);
        row.images.emplace_back().latents.assign(integers.begin(), integers.end());
      }
      const size_t count = state_->model->plan.number_count();
      const auto numbers = std::span(latents.numbers).subspan(at * count, count);
      row.numbers.assign(numbers.begin(), numbers.end());
      auto value = state_->model->decode(row, 0, latents.remainders[at]);
      // The same error is data loss in a store, but here the caller passed the latents.
      if (!value.ok()) return invalid_argument("latents {}: {}", at, value.status().message());
      values.push_back(std::move(value).value());
    }
    return values;
  });
}

Result<LatentArrays> OpenModel::stored(std::span<const ltm::Latent> latents) {
  LatentArrays arrays = state_->no_arrays();
  const LatentBlockCodec& codec = state_->model->codec;
  Buffer block;
  uint32_t rows_of_block = 0;
  size_t chain_rows = 1;
  std::vector<LatentRows> chains;
  for (const ltm::Latent& latent : latents) {
    const auto [index, count] = latent.place;
    if (index >= count)
      return data_loss("latent: found place {} in a block of {} rows", index, count);
    // Snapshots of a block share its code, and callers pass them in order: each block is decoded
    // once.
    if (count != rows_of_block || !std::ranges::equal(block.bytes(), latent.code.bytes())) {
      rows_of_block = 0;
      ENGRAM_ASSIGN_OR_RETURN(const OpenBlock open, codec.open(latent.code.bytes(), count));
      ENGRAM_ASSIGN_OR_RETURN(chains, codec.decode_all(latent.code.bytes(), count));
      chain_rows = open.chain_rows;
      block = latent.code;
      rows_of_block = count;
    }
    state_->add_row(chains[index / chain_rows], index % chain_rows, arrays);
    arrays.remainders.push_back(latent.remainder);
  }
  return arrays;
}

idf::NdArray OpenModel::background(const LatentArrays& latents, size_t image, size_t value) const {
  const Autoencoder& networks = state_->model->autoencoder;
  const idf::NdArray& own = latents.own.at(image).at(value);
  torch::NoGradGuard no_gradient;
  torch::Tensor background;
  if (own.count() > 0) {
    const ImageMember& member = state_->model->plan.images()[image];
    const torch::Tensor pixels =
        torch::from_blob(const_cast<std::byte*>(own.bytes().data()),
                         {1, member.height, member.width, member.channels}, torch::kUInt8);
    background = to_grey_levels(member, networks->shape.images[image], pixels)[0];
  } else {
    background = networks->images[image]->background[latents.scenes.at(value)] * kGreyLevels;
  }
  return idf::NdArray::take<float>(background.sizes().vec(), floats_of(background.detach()));
}

Result<std::vector<std::vector<float>>> OpenModel::global_codes(std::span<const idf::Data> values) {
  return guarded("global codes", [&]() -> Result<std::vector<std::vector<float>>> {
    std::vector<std::vector<float>> codes;
    for (const idf::Data& value : values) {
      ENGRAM_ASSIGN_OR_RETURN(codes.emplace_back(), state_->model->global_code_of(value));
    }
    return codes;
  });
}

std::vector<NamedWeights> OpenModel::weights() const {
  std::vector<NamedWeights> weights;
  const auto add = [&](const std::string& network, const std::string& name,
                       const torch::Tensor& tensor) {
    weights.push_back({network + name, idf::NdArray::take<float>(tensor.sizes().vec(),
                                                                 floats_of(tensor.detach()))});
  };
  const auto add_all = [&](const std::string& network, const torch::nn::Module& module) {
    for (const auto& item : module.named_parameters()) add(network, item.key(), item.value());
    for (const auto& item : module.named_buffers()) add(network, item.key(), item.value());
  };
  add_all("autoencoder.", *state_->model->autoencoder);
  add_all("dynamics.", *state_->model->dynamics);
  return weights;
}

}  // namespace engram::encoders
