// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/layers.h"
#include "encoders/network_shape.h"
#include "encoders/view.h"

// Internal to the learning rooms: includes LibTorch.
//
// Letters of shapes, in all headers of networks:
//   B    snapshots of a batch                 C    channels of an image
//   H W  height and width of it, padded       F    features at 1/16 (NetworkSizes::width)
//   Z z  channels of coarse and fine latents  N    numbers beside the images
//   K    numbers of the condition             P    steps that are planned
// Of images above 256 pixels H and W count units of 2 x 2, 4 x 4, ... pixels (ImageShape::unit).

namespace engram::encoders {

/// Values of a batch: a tensor per image member and one for all numbers.
struct Parts {
  std::vector<torch::Tensor> images;  ///< Grey levels [B, C, H, W].
  torch::Tensor numbers;              ///< Normalised [B, N]; undefined without numbers.
  torch::Tensor scene;                ///< Which background, of int64 [B].
  /// Backgrounds of a view that is none of the scenes, per image member [1, C, H, W], in grey
  /// levels; empty: the scene's. `scene` then is the one most like it.
  std::vector<torch::Tensor> backgrounds{};
  /// Numbers of the entity that predictions start from too, normalised [B, K]; undefined where they
  /// are not known.
  torch::Tensor conditions{};
  /// The same as planned for the next steps [B, P, K]; undefined without a plan.
  torch::Tensor plan{};
};

/// The latents of an image at two scales.
struct ImageLatents {
  torch::Tensor coarse;  ///< [B, Z, H/16, W/16], for images of one unit.
  torch::Tensor fine;    ///< [B, z, H/8, W/8].
};

/// What a batch is decoded from. Numbers are not turned into latents: they have a codec of their
/// own, which keeps a bound, and are known when images are decoded.
struct Latents {
  std::vector<ImageLatents> images;
  torch::Tensor numbers;
  torch::Tensor scene;
  std::vector<torch::Tensor> backgrounds{};  ///< As of Parts.
};

/// Image minus background to latents, not rounded.
///
///     image - background [B, C, H, W]
///           | unshuffle by 4, stem 3x3, + View::quarter
///     [B, 3F/8, H/4, W/4]    quarter: 1 block
///           | to_eighth
///     [B, F/2, H/8, W/8]     eighth: 1 block ----- fine 1x1 ----> fine [B, z, H/8, W/8]
///           | to_sixteenth
///     [B, 3F/4, H/16, W/16]  sixteenth: 2 blocks - coarse 1x1 --> coarse [B, Z, H/16, W/16]
///
/// Source: our own structure; latents that cost bits in training follow Ballé et al., End-to-end
/// Optimized Image Compression, 2017.
struct ImageEncoderImpl : torch::nn::Module {
  ImageEncoderImpl(const ImageShape& shape, const NetworkSizes& sizes);
  ImageLatents forward(const torch::Tensor& x, const View& view);

  int unit;
  torch::nn::Conv2d stem{nullptr}, to_eighth{nullptr}, to_sixteenth{nullptr};
  torch::nn::Conv2d fine{nullptr}, coarse{nullptr};
  ResidualBlock quarter{nullptr}, eighth{nullptr};
  ResidualBlocks sixteenth{nullptr};
};
TORCH_MODULE(ImageEncoder);

/// Latents to image minus background. Most weights lie where places are few: it may know a scene by
/// heart and stay quick.
///
///     coarse latents [B, Z, H/16, W/16]
///           | from_coarse 3x3, + View::sixteenth, + from_numbers (of [B, N])
///     [B, F, H/16, W/16]     sixteenth: 2 blocks
///           | to_eighth, + from_fine 3x3 of the fine latents [B, z, H/8, W/8], + View::eighth
///     [B, 3F/4, H/8, W/8]    eighth: 2 blocks
///           | to_quarter, + View::quarter
///     [B, 3F/8, H/4, W/4]    quarter: 2 blocks
///           | to_half
///     [B, 3F/16, H/2, W/2]   half: 1 block
///           | out 3x3, shuffle by 2
///     [B, C, H, W]
///
/// Source: our own.
struct ImageDecoderImpl : torch::nn::Module {
  ImageDecoderImpl(const ImageShape& shape, const NetworkSizes& sizes, int numbers);
  torch::Tensor forward(const ImageLatents& latents, const torch::Tensor& numbers,
                        const View& view);

  int unit;
  torch::nn::Conv2d from_coarse{nullptr}, from_fine{nullptr};
  torch::nn::Conv2d to_eighth{nullptr}, to_quarter{nullptr}, to_half{nullptr}, out{nullptr};
  torch::nn::Linear from_numbers{nullptr};
  ResidualBlocks sixteenth{nullptr}, eighth{nullptr}, quarter{nullptr};
  ResidualBlock half{nullptr};
};
TORCH_MODULE(ImageDecoder);

/// One image member: a background per scene, and what differs from it.
///
///     image --(-)--> encoder --> latents --> decoder --(+)--> image
///              |        |                      |        |
///              +--------+---- background ------+--------+   [scenes, C, H, W]
///                       |                      |
///                       +--- places (View) ----+
struct ImageAutoencoderImpl : torch::nn::Module {
  ImageAutoencoderImpl(const ImageShape& shape, const NetworkSizes& sizes, int numbers);

  ImageLatents encode(const torch::Tensor& x, const View& view);
  torch::Tensor decode(const ImageLatents& latents, const torch::Tensor& numbers, const View& view);

  torch::Tensor background;  ///< [scenes, C, H, W], in units of kGreyLevels.
  PlaceFeatures places{nullptr};
  ImageEncoder encoder{nullptr};
  ImageDecoder decoder{nullptr};
};
TORCH_MODULE(ImageAutoencoder);

/// The autoencoder of one entity: all its images.
///
/// Source: docs/learning_methods.md, section "The image autoencoder".
struct AutoencoderImpl : torch::nn::Module {
  explicit AutoencoderImpl(const NetworkShape& shape);

  /// What is known of each row of a batch. Shape: `scene` of int64 [B], negative: none;
  /// `backgrounds` per image member [B, C, H, W], in grey levels, or none: those of the scenes.
  Views look(const torch::Tensor& scene, const std::vector<torch::Tensor>& backgrounds);
  /// Of all rows together where they are alike. `backgrounds` as of Parts.
  Views views_of(const torch::Tensor& scene, const std::vector<torch::Tensor>& backgrounds);

  /// Not rounded.
  Latents encode(const Parts& values, const Views& views);
  Latents encode(const Parts& values) {
    return encode(values, views_of(values.scene, values.backgrounds));
  }
  /// Images whose latents are undefined stay so.
  Parts decode(const Latents& latents, const Views& views);
  Parts decode(const Latents& latents) {
    return decode(latents, views_of(latents.scene, latents.backgrounds));
  }

  /// Sum over all pixels of how far an image is from the background of each scene. [B, scenes]
  torch::Tensor distances(const Parts& values);

  NetworkShape shape;
  std::vector<ImageAutoencoder> images;  ///< None where the sizes say so.

 private:
  /// The last views that views_of() made of one row without gradients: decoding asks for the same
  /// again and again.
  struct LastViews {
    torch::Tensor scene;
    std::vector<torch::Tensor> backgrounds;
    int64_t weights_version = -1;
    Views views;
  };

  /// Grows with every change of the weights that views are made with.
  [[nodiscard]] int64_t weights_version() const;

  LastViews last_views_;
};
TORCH_MODULE(Autoencoder);

/// Every latent rounded to an integer.
[[nodiscard]] Latents round(const Latents& latents);

}  // namespace engram::encoders
