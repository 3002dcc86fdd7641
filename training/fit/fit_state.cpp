// SPDX-License-Identifier: Apache-2.0
#include "training/fit/fit_state.h"

#include <ATen/CPUGeneratorImpl.h>

#include <cmath>
#include <cstring>
#include <mutex>

namespace engram::training {

using torch::Tensor;
using torch::optim::AdamParamState;

namespace {

template <typename T>
idf::NdArray array_of(const Tensor& tensor) {
  const Tensor flat = tensor.detach().contiguous();
  const auto* first = flat.data_ptr<T>();
  return idf::NdArray::take<T>(flat.sizes().vec(), std::vector<T>(first, first + flat.numel()));
}

/// Converts an array to a tensor with the shape and layout of `like`.
Result<Tensor> tensor_of(const idf::Data& data, const Tensor& like) {
  const auto* array = data.get_if<idf::NdArray>();
  if (array == nullptr || array->type() != idf::ElementType::kFloat32 ||
      array->shape() != like.sizes().vec())
    return data_loss("a tensor: found {}, needs float32 {}",
                     array == nullptr ? data.kind_name() : idf::to_string(array->shape()),
                     idf::to_string(like.sizes().vec()));
  const auto values = array->values<float>();
  Tensor flat = torch::empty(like.sizes(), torch::kFloat32);
  std::memcpy(flat.data_ptr<float>(), values.data(), values.size_bytes());
  if (!torch::isfinite(flat).all().item<bool>())
    return data_loss("a tensor: found numbers that are not finite");
  return torch::zeros_like(like).copy_(flat);
}

/// All weights of both networks.
std::vector<Tensor> weights_of(encoders::DeepModel& model) {
  std::vector<Tensor> weights = model.autoencoder->parameters();
  for (const Tensor& tensor : model.dynamics->parameters()) weights.push_back(tensor);
  return weights;
}

std::vector<Tensor> trained_by(torch::optim::Adam& optimiser) {
  std::vector<Tensor> tensors;
  for (const auto& group : optimiser.param_groups())
    tensors.insert(tensors.end(), group.params().begin(), group.params().end());
  return tensors;
}

/// All numbers that change.
std::vector<double*> numbers_of(const FitState& state) {
  FitStep& now = state.now;
  std::vector<double*> numbers{&now.loss, &now.psnr_db, &now.bytes, &now.price};
  numbers.insert(numbers.end(), state.numbers.begin(), state.numbers.end());
  return numbers;
}

std::string key_of(const Tensor& tensor) {
  return c10::guts::to_string(tensor.unsafeGetTensorImpl());
}

/// The moments of a tensor; None if the optimiser never had a gradient of it.
idf::Data moments_of(torch::optim::Adam& optimiser, const Tensor& tensor) {
  const auto found = optimiser.state().find(key_of(tensor));
  if (found == optimiser.state().end()) return {};
  const auto& adam = static_cast<const AdamParamState&>(*found->second);
  return idf::Dict{{"steps", adam.step()},
                   {"mean", array_of<float>(adam.exp_avg())},
                   {"square", array_of<float>(adam.exp_avg_sq())}};
}

using StateMoments = std::vector<std::unique_ptr<AdamParamState>>;

Result<StateMoments> kept_moments(const idf::List& kept, const std::vector<Tensor>& tensors) {
  if (kept.size() != tensors.size())
    return data_loss("moments: found {}, needs {}", kept.size(), tensors.size());
  StateMoments moments;
  for (size_t i = 0; i < kept.size(); ++i) {
    moments.emplace_back();
    if (kept[i].is<idf::None>()) continue;
    const idf::Data* steps = kept[i].at("steps");
    const idf::Data* mean = kept[i].at("mean");
    const idf::Data* square = kept[i].at("square");
    if (steps == nullptr || mean == nullptr || square == nullptr || !steps->is<int64_t>() ||
        steps->get<int64_t>() < 1)
      return data_loss("moments {}: need steps, mean and square", i);
    auto adam = std::make_unique<AdamParamState>();
    adam->step(steps->get<int64_t>());
    ENGRAM_ASSIGN_OR_RETURN(Tensor first, tensor_of(*mean, tensors[i]));
    ENGRAM_ASSIGN_OR_RETURN(Tensor second, tensor_of(*square, tensors[i]));
    adam->exp_avg(std::move(first));
    adam->exp_avg_sq(std::move(second));
    moments.back() = std::move(adam);
  }
  return moments;
}

void set_moments(StateMoments moments, const std::vector<Tensor>& tensors,
                 torch::optim::Adam& optimiser) {
  optimiser.state().clear();
  for (size_t i = 0; i < moments.size(); ++i) {
    if (!moments[i]) continue;
    optimiser.state()[key_of(tensors[i])] = std::move(moments[i]);
  }
}

Result<std::vector<Tensor>> kept_weights(const idf::Data& kept, encoders::DeepModel& model) {
  const auto weights = weights_of(model);
  const idf::Data* list = kept.at("weights");
  if (list == nullptr || !list->is<idf::List>() || list->get<idf::List>().size() != weights.size())
    return data_loss("needs {} weights", weights.size());
  std::vector<Tensor> found;
  for (size_t i = 0; i < weights.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(found.emplace_back(),
                            tensor_of(list->get<idf::List>()[i], weights[i].detach()));
  }
  return found;
}

void set_weights(const std::vector<Tensor>& found, encoders::DeepModel& model) {
  torch::NoGradGuard no_grad;
  auto weights = weights_of(model);
  for (size_t i = 0; i < weights.size(); ++i) weights[i].copy_(found[i]);
}

Tensor generator_state() {
  auto generator = at::detail::getDefaultCPUGenerator();
  const std::lock_guard lock(generator.mutex());
  return generator.get_state();
}

/// Restores the random generator. A state that LibTorch refuses is data loss.
Status set_generator(const idf::Data* kept) {
  const auto* array = kept == nullptr ? nullptr : kept->get_if<idf::NdArray>();
  if (array == nullptr || array->type() != idf::ElementType::kUInt8 || array->rank() != 1)
    return data_loss("needs the state of a random generator");
  Tensor state = torch::empty(array->shape(), torch::kUInt8);
  std::memcpy(state.data_ptr<uint8_t>(), array->bytes().data(), array->bytes().size());
  auto generator = at::detail::getDefaultCPUGenerator();
  const std::lock_guard lock(generator.mutex());
  try {
    generator.set_state(state);
  } catch (const c10::Error&) {
    return data_loss("its state of a random generator is none");
  }
  return {};
}

}  // namespace

idf::Data kept_state(const FitState& state) {
  idf::List weights, moments;
  for (const Tensor& tensor : weights_of(state.model)) weights.push_back(array_of<float>(tensor));
  for (const Tensor& tensor : trained_by(state.optimiser))
    moments.push_back(moments_of(state.optimiser, tensor));
  std::vector<double> numbers;
  for (const double* number : numbers_of(state)) numbers.push_back(*number);
  const auto count = static_cast<int64_t>(numbers.size());
  return idf::Dict{{"step", state.now.step},
                   {"weights", std::move(weights)},
                   {"moments", std::move(moments)},
                   {"numbers", idf::NdArray::take<double>({count}, std::move(numbers))},
                   {"generator", array_of<uint8_t>(generator_state())}};
}

Status restore_state(const idf::Data& kept, FitState& state) {
  const auto tensors = trained_by(state.optimiser);
  ENGRAM_ASSIGN_OR_RETURN(const auto weights, kept_weights(kept, state.model));
  const idf::Data* list = kept.at("moments");
  if (list == nullptr || !list->is<idf::List>()) return data_loss("needs moments");
  ENGRAM_ASSIGN_OR_RETURN(StateMoments moments, kept_moments(list->get<idf::List>(), tensors));
  const idf::Data* step = kept.at("step");
  const idf::Data* numbers = kept.at("numbers");
  const auto* array = numbers == nullptr ? nullptr : numbers->get_if<idf::NdArray>();
  const auto places = numbers_of(state);
  const idf::Shape shape{static_cast<int64_t>(places.size())};
  if (step == nullptr || !step->is<int64_t>() || step->get<int64_t>() < 0 || array == nullptr ||
      array->type() != idf::ElementType::kFloat64 || array->shape() != shape)
    return data_loss("needs the number of steps and {} other numbers", shape.front());
  // Everything that can fail comes before the first change, so a refused state changes nothing.
  ENGRAM_RETURN_IF_ERROR(set_generator(kept.at("generator")));
  const auto values = array->values<double>();
  state.now.step = step->get<int64_t>();
  for (size_t i = 0; i < places.size(); ++i) *places[i] = values[i];
  set_weights(weights, state.model);
  set_moments(std::move(moments), tensors, state.optimiser);
  return {};
}

Status restore_weights(const idf::Data& kept, encoders::DeepModel& model) {
  ENGRAM_ASSIGN_OR_RETURN(const auto weights, kept_weights(kept, model));
  set_weights(weights, model);
  return {};
}

}  // namespace engram::training
