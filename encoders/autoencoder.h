// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/latent_code.h"
#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.
//
// B batch, C channels of an image, H W its size (padded), S the stride 8 or 16, Z latent channels,
// h = H/S, w = W/S, N numbers, M latents of the numbers, F features.

namespace engram::encoders {

/// One tensor per image member and one for all numbers; of values or of latents. `numbers` is
/// undefined where there are none.
struct Parts {
  std::vector<torch::Tensor> images;
  torch::Tensor numbers;
};

/// What is known of an image member before training.
struct ImageShape {
  int channels = 3;
  int height = 0;  ///< Padded to a multiple of stride.
  int width = 0;
  int stride = 8;
};

/// Sizes of the networks of one model.
struct NetworkShape {
  std::vector<ImageShape> images;
  int numbers = 0;
  int width = 48;            ///< Features at twice the resolution of the latents.
  int latent_channels = 24;  ///< Of each image.
  int number_latents = 0;

  /// The grids of the latents, that of the numbers last.
  [[nodiscard]] std::vector<LatentGrid> grids() const;
};

/// Two 3x3 convolutions beside an identity; starts as the identity.
struct ResidualBlockImpl : torch::nn::Module {
  explicit ResidualBlockImpl(int features);
  torch::Tensor forward(const torch::Tensor& x);

  torch::nn::Conv2d first{nullptr}, second{nullptr};
};
TORCH_MODULE(ResidualBlock);

/// Image to latents and back: a linear transform of patches plus what a network adds to it.
///
///     x - background -> patches -> linear ------------------+-> z
///                   \-> unshuffle -> conv, residual block --/
///     z -> linear -> patches ----------------------------------------------+-> + background -> x
///      \-> conv (+ numbers) -> residual blocks -> shuffle -> block, conv --/
///
/// The linear parts start as the Karhunen-Loeve transform of the training data, the networks at
/// zero. Source: docs/learning.md, section "The image autoencoder".
struct ImageAutoencoderImpl : torch::nn::Module {
  ImageAutoencoderImpl(const ImageShape& shape, const NetworkShape& network);

  /// Grey levels [B, C, H, W] -> [B, Z, h, w], not rounded.
  torch::Tensor encode(const torch::Tensor& x);

  /// Rounded latents [B, Z, h, w] and numeric latents [B, M] or undefined -> [B, C, H, W].
  torch::Tensor decode(const torch::Tensor& z, const torch::Tensor& numbers);

  /// Bits that the latents cost, estimated from their neighbours. [B, Z, h, w] -> [B].
  torch::Tensor bits(const torch::Tensor& z);

  /// Sets the background to the median and the linear parts to the transform of `x` [n, C, H, W],
  /// quantised so finely that the squared error is `mse`. Unit: grey levels squared.
  void initialise(const torch::Tensor& x, double mse);

  [[nodiscard]] std::vector<torch::Tensor> linear_parameters() const;

  ImageShape shape;
  torch::Tensor background;    ///< [1, C, H, W], in units of kGreyLevels.
  torch::Tensor latent_scale;  ///< [1, Z, 1, 1], typical size of the latents.
  torch::Tensor prior;         ///< [3, Z, 1, 1]: weights of the scale of the distribution.
  torch::nn::Conv2d analysis{nullptr}, synthesis{nullptr};
  torch::nn::Conv2d stem{nullptr}, down{nullptr}, code{nullptr};
  torch::nn::Conv2d from_code{nullptr}, up{nullptr}, out{nullptr};
  torch::nn::Linear from_numbers{nullptr};
  ResidualBlock encoder_block{nullptr}, decoder_block_1{nullptr}, decoder_block_2{nullptr},
      fine_block{nullptr};
};
TORCH_MODULE(ImageAutoencoder);

/// Numbers to latents and back: a linear transform plus what dense layers add to it.
/// Numbers are normalised: mean 0, standard deviation 1.
struct NumberAutoencoderImpl : torch::nn::Module {
  NumberAutoencoderImpl(int numbers, int latents);

  torch::Tensor encode(const torch::Tensor& x);  // [B, N] -> [B, M]
  torch::Tensor decode(const torch::Tensor& z);  // [B, M] -> [B, N]
  torch::Tensor bits(const torch::Tensor& z);    // [B, M] -> [B]

  /// Sets the linear parts to the transform of `x` [n, N] with squared error `mse`.
  void initialise(const torch::Tensor& x, double mse);

  [[nodiscard]] std::vector<torch::Tensor> linear_parameters() const;

  torch::Tensor latent_scale;  ///< [1, M].
  torch::Tensor log_spread;    ///< [1, M].
  torch::nn::Linear analysis{nullptr}, synthesis{nullptr};
  torch::nn::Linear encode_1{nullptr}, encode_2{nullptr}, decode_1{nullptr}, decode_2{nullptr};
};
TORCH_MODULE(NumberAutoencoder);

/// The autoencoder of one entity: all its images and numbers.
struct AutoencoderImpl : torch::nn::Module {
  explicit AutoencoderImpl(const NetworkShape& shape);

  Parts encode(const Parts& values);
  Parts decode(const Parts& latents);

  NetworkShape shape;
  std::vector<ImageAutoencoder> images;
  NumberAutoencoder numbers{nullptr};
};
TORCH_MODULE(Autoencoder);

/// A unit of the networks' image side. Unit: grey levels.
inline constexpr double kGreyLevels = 64.0;

/// Every latent rounded to an integer.
[[nodiscard]] Parts round(const Parts& latents);

/// A convolution that keeps the size and starts at zero where `starts_at_zero`.
[[nodiscard]] torch::nn::Conv2d make_conv(int in, int out, int kernel, bool starts_at_zero = false);

/// A dense layer that starts at zero.
[[nodiscard]] torch::nn::Linear make_zero_linear(int in, int out);

}  // namespace engram::encoders
