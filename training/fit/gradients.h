// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Freezes the parameters of a module as long as it lives.
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

/// The next step's are taken as they come, and what has none is left as it is; LibTorch's own
/// zero_grad fills and adds, or not, depending on its version.
inline void forget_gradients(torch::optim::Optimizer& optimiser) {
  for (auto& group : optimiser.param_groups())
    for (torch::Tensor& parameter : group.params()) parameter.mutable_grad().reset();
}

}  // namespace engram::training
