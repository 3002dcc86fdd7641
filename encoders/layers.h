// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.
//
// The layers of all networks. In shapes, B is the batch, C channels, H and W height and width, F
// features.
//
// A model file holds the tensors of a network in the order in which its modules register them, and
// no names. So a member or its registered name may be renamed, but the order of register_module()
// and register_parameter() may not change: old files would be read into the wrong tensors. A few
// names have a meaning: a tensor whose name ends in "background" is kept as pixels
// (weight_rounding.h), and training finds the tensors of a warm start and of the motion by name.

namespace engram::encoders {

/// One unit of the input and output of the networks for images. Unit: grey levels.
inline constexpr double kGreyLevels = 64.0;

[[nodiscard]] torch::Tensor activate(const torch::Tensor& x);

/// The same in place, for a tensor that is no view and that is not used elsewhere.
[[nodiscard]] torch::Tensor activate(torch::Tensor&& x);

/// [B, C, H, W] -> [B, C factor^2, H / factor, W / factor], channels last in memory.
[[nodiscard]] torch::Tensor unshuffled(const torch::Tensor& x, int factor);

/// Applies `conv`, a 1x1 convolution, to unshuffled(x, 2), as one convolution with stride 2.
[[nodiscard]] torch::Tensor halved(torch::nn::Conv2d& conv, const torch::Tensor& x);

/// pixel_shuffle(conv(x), 2) of a 1x1 convolution, computed as one matrix product. It trains faster
/// here than a transposed convolution.
/// Source: Shi et al., Real-Time Single Image and Video Super-Resolution Using an Efficient
/// Sub-Pixel Convolutional Neural Network, 2016.
[[nodiscard]] torch::Tensor doubled(torch::nn::Conv2d& conv, const torch::Tensor& x);

/// Adds features of views to x, in which each view has N consecutive rows.
/// Shape: x [N B, C, H, W], known [B, C, H, W].
[[nodiscard]] torch::Tensor with_known(const torch::Tensor& x, const torch::Tensor& known);

/// A convolution that keeps the size. Its weights start at zero if `starts_at_zero`.
[[nodiscard]] torch::nn::Conv2d make_conv(int in, int out, int kernel, bool starts_at_zero = false);

/// A dense layer whose weights start at zero.
[[nodiscard]] torch::nn::Linear make_zero_linear(int in, int out);

/// Adds a vector of features [B, F] to every place of x [B, F, H, W].
[[nodiscard]] torch::Tensor with_features(const torch::Tensor& x, const torch::Tensor& features);

/// Two 3x3 convolutions beside an identity. The block starts as the identity, because its second
/// convolution starts at zero.
///
///     x --+-- first 3x3 -- activate -- second 3x3 --(+)-- y        x, y [B, F, H, W]
///         +------------------------------------------+
///
/// B is the batch, F the features, H and W are height and width.
/// Source: He et al., Deep Residual Learning for Image Recognition, 2016. There is no
/// normalisation, and nothing is activated before the first convolution or after the sum, as in Lim
/// et al., Enhanced Deep Residual Networks for Single Image Super-Resolution, 2017. The leaky
/// activation and the start at zero are our choice.
struct ResidualBlockImpl : torch::nn::Module {
  explicit ResidualBlockImpl(int features);
  torch::Tensor forward(const torch::Tensor& x);

  torch::nn::Conv2d first{nullptr}, second{nullptr};
};
TORCH_MODULE(ResidualBlock);

/// Several residual blocks, one after the other.
///
///     x -- block0 -- block1 -- ... -- block(count - 1) -- y        x, y [B, F, H, W]
///
/// All blocks keep the shape. B is the batch, F the features, H and W are height and width.
/// Source: as ResidualBlock. A chain of blocks starts as the identity too.
struct ResidualBlocksImpl : torch::nn::Module {
  ResidualBlocksImpl(int features, int count);
  torch::Tensor forward(const torch::Tensor& x);

  std::vector<ResidualBlock> blocks;
};
TORCH_MODULE(ResidualBlocks);

}  // namespace engram::encoders
