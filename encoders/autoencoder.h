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
//   H W  its height and width, padded         F    features at 1/16 (NetworkSizes::width)
//   Z z  channels of coarse and fine latents  N    numbers beside the images
//   K    numbers of the condition             P    steps that are planned
// For images with a side above 256 pixels, H and W count units of 2 x 2, 4 x 4, ... pixels
// (ImageShape::unit).

namespace engram::encoders {

/// Values of a batch: a tensor per image member and one for all numbers.
struct Parts {
  std::vector<torch::Tensor> images;  ///< Grey levels [B, C, H, W].
  torch::Tensor numbers;              ///< Normalised [B, N]; undefined without numbers.
  torch::Tensor scene;                ///< Index of the background of each row, int64 [B].
  /// Backgrounds of a view that is none of the trained scenes, per image member [1, C, H, W], in
  /// grey levels; `scene` then names the most similar scene. If it is empty, the scene's background
  /// is used.
  std::vector<torch::Tensor> backgrounds{};
  /// Numbers of the entity that conditions predictions, normalised [B, K]; undefined if they are
  /// not known.
  torch::Tensor conditions{};
  /// Planned values of these numbers at the next steps [B, P, K]; undefined without a plan.
  torch::Tensor plan{};
};

/// The latents of an image at two scales.
struct ImageLatents {
  torch::Tensor coarse;  ///< [B, Z, H/16, W/16], for images of one unit.
  torch::Tensor fine;    ///< [B, z, H/8, W/8].
};

/// The input of the decoder. Numbers are not turned into latents: their own codec keeps an error
/// bound, and they are already decoded when the images are.
struct Latents {
  std::vector<ImageLatents> images;
  torch::Tensor numbers;
  torch::Tensor scene;
  std::vector<torch::Tensor> backgrounds{};  ///< As in Parts.
};

/// Maps an image minus its background to latents that are not rounded.
///
///     image - background [B, C, H, W]
///           | unshuffle by 4, stem 3x3, + View::quarter
///     [B, 3F/8, H/4, W/4]    quarter: 1 block
///           | to_eighth
///     [B, F/2, H/8, W/8]     eighth: 1 block ----- fine 1x1 ----> fine [B, z, H/8, W/8]
///           | to_sixteenth
///     [B, 3F/4, H/16, W/16]  sixteenth: 2 blocks - coarse 1x1 --> coarse [B, Z, H/16, W/16]
///
/// Source: our own structure; the cost of latents in bits during training follows Ballé et al.,
/// End-to-end Optimized Image Compression, 2017.
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

/// Maps latents to an image minus its background. Most weights lie at the coarsest scale, where
/// there are few places, so the decoder can memorise a scene and still be fast.
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

/// The networks of one image member: one background per scene, and an autoencoder of the difference
/// to it.
///
///     image --(-)--> encoder --> latents --> decoder --(+)--> image
///              |        |                      |        |
///              +--------+---- background ------+--------+   [scenes, C, H, W]
///                       |                      |
///                       +--- places (View) ----+
///
/// The background is a parameter: it starts as the median image of a recording and is trained.
/// Letters are those at the top of this file.
/// Source: docs/learning_methods.md, section "The image autoencoder". As in Ballé et al.,
/// End-to-end Optimized Image Compression, 2017, an encoder and a decoder are trained together for
/// squared error and the bits of quantised latents (variant "rate"). Two scales of latents,
/// backgrounds and places are our own.
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

/// The autoencoder of one entity: one ImageAutoencoder per image member.
///
///     image i [B, C, H, W] --> images[i] encodes --> latents i --> images[i] decodes --> image i
///     numbers [B, N], normalised ------------------------------------+
///
/// Letters are those at the top of this file.
/// Source: docs/learning_methods.md, section "The image autoencoder"; papers as ImageAutoencoder.
struct AutoencoderImpl : torch::nn::Module {
  explicit AutoencoderImpl(const NetworkShape& shape);

  /// Makes the view of each row of a batch.
  /// Shape: `scene` int64 [B], negative for a view that is no trained scene; `backgrounds` per
  /// image member [B, C, H, W], in grey levels, or empty to use those of the scenes.
  Views look(const torch::Tensor& scene, const std::vector<torch::Tensor>& backgrounds);
  /// Makes one view for all rows if they have the same scene, else one per row. `backgrounds` as in
  /// Parts.
  Views views_of(const torch::Tensor& scene, const std::vector<torch::Tensor>& backgrounds);

  /// Returns latents that are not rounded.
  Latents encode(const Parts& values, const Views& views);
  Latents encode(const Parts& values) {
    return encode(values, views_of(values.scene, values.backgrounds));
  }
  /// Images whose latents are undefined stay undefined.
  Parts decode(const Latents& latents, const Views& views);
  Parts decode(const Latents& latents) {
    return decode(latents, views_of(latents.scene, latents.backgrounds));
  }

  /// Sum over all pixels of the distance between an image and the background of each scene.
  /// Shape: [B, scenes].
  torch::Tensor distances(const Parts& values);

  NetworkShape shape;
  std::vector<ImageAutoencoder> images;  ///< Empty if the width is 0.

 private:
  /// The last views that views_of() made of one row without gradients. They are kept because
  /// decoding asks for the same views many times.
  struct LastViews {
    torch::Tensor scene;
    std::vector<torch::Tensor> backgrounds;
    int64_t weights_version = -1;
    Views views;
  };

  /// Grows with every change of the weights that make views.
  [[nodiscard]] int64_t weights_version() const;

  LastViews last_views_;
};
TORCH_MODULE(Autoencoder);

/// Rounds every latent to an integer.
[[nodiscard]] Latents round(const Latents& latents);

}  // namespace engram::encoders
