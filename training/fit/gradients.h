// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Freezes the parameters of a module during its lifetime.
class FrozenParameters {
 public:
  explicit FrozenParameters(torch::nn::Module& module) : parameters_(module.parameters()) {
    set(false);
  }
  ~FrozenParameters() { set(true); }
  FrozenParameters(const FrozenParameters&) = delete;
  FrozenParameters& operator=(const FrozenParameters&) = delete;

 private:
  void set(bool is_trained) {
    for (torch::Tensor& parameter : parameters_) parameter.set_requires_grad(is_trained);
  }
  std::vector<torch::Tensor> parameters_;
};

/// Removes all gradients, so that the next step leaves parameters without one unchanged. LibTorch's
/// zero_grad is not used, because it fills with zeros or not depending on its version.
inline void forget_gradients(torch::optim::Optimizer& optimiser) {
  for (auto& group : optimiser.param_groups())
    for (torch::Tensor& parameter : group.params()) parameter.mutable_grad().reset();
}

}  // namespace engram::training
