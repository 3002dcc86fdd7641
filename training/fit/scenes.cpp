// SPDX-License-Identifier: Apache-2.0
#include "training/fit/scenes.h"

#include <algorithm>

namespace engram::training {

using torch::Tensor;

namespace {

/// Max number of evenly spaced images of a median.
constexpr size_t kMaxMedianImages = 64;
/// Recordings whose medians differ by less on average share a background. Unit: grey levels.
constexpr double kAlike = 3.0;
constexpr size_t kMaxScenes = 16;

/// The median image of a sequence per member. Shape: [1, C, H, W].
std::vector<Tensor> medians_of(const Dataset& data, const encoders::NetworkShape& shape,
                               const Sequence& sequence) {
  const size_t step = (sequence.size() + kMaxMedianImages - 1) / kMaxMedianImages;
  const auto rows =
      torch::arange(static_cast<int64_t>(sequence.first), static_cast<int64_t>(sequence.end),
                    static_cast<int64_t>(step), torch::kLong);
  std::vector<Tensor> medians;
  for (const Tensor& images : data.batch(shape, rows).images)
    medians.push_back(std::get<0>(images.median(0, true)));
  return medians;
}

/// Mean difference over the pixels of all members.
double difference(const std::vector<Tensor>& a, const std::vector<Tensor>& b) {
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - b[i]).abs().sum().item<double>();
    count += static_cast<double>(a[i].numel());
  }
  return sum / count;
}

/// All scenes of a member after coding in each quality; undefined if no codec accepts them.
Tensor coded(const encoders::ImageMember& member, const encoders::ImageShape& shape,
             const Tensor& backgrounds) {
  if (member.is_depth) return {};
  std::vector<Tensor> all;
  for (size_t quality = 0; quality < encoders::kBackgroundQualities; ++quality)
    for (int64_t scene = 0; scene < backgrounds.size(0); ++scene) {
      const auto image = encoders::to_image_array(member, backgrounds.slice(0, scene, scene + 1));
      const auto one = encoders::code_background(image, quality);
      if (!one.ok() || !*one) return {};
      const Tensor pixels =
          torch::from_blob(const_cast<std::byte*>((*one)->pixels.bytes().data()),
                           {1, member.height, member.width, member.channels}, torch::kUInt8);
      all.push_back(encoders::to_grey_levels(member, shape, pixels));
    }
  return torch::cat(all);
}

void code_backgrounds(Dataset& data, const encoders::NetworkShape& shape) {
  if (data.scenes() < 2) return;
  for (size_t i = 0; i < data.backgrounds.size(); ++i) {
    data.coded_backgrounds.push_back(
        coded(data.plan.images()[i], shape.images[i], data.backgrounds[i]));
    if (data.coded_backgrounds.back().defined()) continue;
    data.coded_backgrounds.clear();
    return;
  }
}

/// One appearance of a scene.
struct Look {
  int64_t scene = 0;
  std::vector<Tensor> image;  ///< Per member. [1, C, H, W]
};

/// The backgrounds of a model, per scene and member. Shape: [1, C, H, W].
std::vector<std::vector<Tensor>> scenes_of(const encoders::DeepModel& model) {
  torch::NoGradGuard no_grad;
  std::vector<std::vector<Tensor>> scenes(
      static_cast<size_t>(model.autoencoder->shape.sizes.scenes));
  for (const auto& image : model.autoencoder->images)
    for (size_t i = 0; i < scenes.size(); ++i) {
      const auto at = static_cast<int64_t>(i);
      scenes[i].push_back(image->background.slice(0, at, at + 1) * encoders::kGreyLevels);
    }
  return scenes;
}

}  // namespace

void find_scenes(Dataset& data, const encoders::DeepModel* start) {
  const auto shape = encoders::network_shape(data.plan, {});
  size_t max_scenes = kMaxScenes;
  for (const auto& image : shape.images)
    max_scenes = std::min(max_scenes, static_cast<size_t>(encoders::max_scenes(image)));
  std::vector<std::vector<Tensor>> scenes;
  if (start != nullptr && !start->autoencoder->images.empty()) scenes = scenes_of(*start);
  data.known_scenes = static_cast<int64_t>(scenes.size());
  std::vector<Look> looks;
  for (const auto& scene : scenes) looks.push_back({static_cast<int64_t>(looks.size()), scene});
  for (const Sequence& sequence : data.sequences) {
    const std::vector<Tensor> medians = medians_of(data, shape, sequence);
    std::vector<double> differences;
    for (const Look& look : looks) differences.push_back(difference(look.image, medians));
    auto nearest = std::ranges::min_element(differences);
    // Trained backgrounds are no longer medians, so the medians of their recordings are compared
    // too.
    const bool is_known = data.known_scenes > 0 && data.is_known[sequence.first];
    const bool is_new = nearest == differences.end() ||
                        (!is_known && *nearest >= kAlike && scenes.size() < max_scenes);
    const int64_t scene = is_new ? static_cast<int64_t>(scenes.size())
                                 : looks[static_cast<size_t>(nearest - differences.begin())].scene;
    if (is_new) scenes.push_back(medians);
    if (is_new || is_known) looks.push_back({scene, medians});
    data.scene.slice(0, static_cast<int64_t>(sequence.first), static_cast<int64_t>(sequence.end))
        .fill_(scene);
  }
  for (size_t i = 0; i < data.images.size(); ++i) {
    std::vector<Tensor> of_member;
    for (const auto& scene : scenes) of_member.push_back(scene[i]);
    data.backgrounds.push_back(torch::cat(of_member));
  }
  code_backgrounds(data, shape);
}

int64_t nearest_scene(const Dataset& data, const Sequence& sequence) {
  const std::vector<Tensor> medians =
      medians_of(data, encoders::network_shape(data.plan, {}), sequence);
  std::vector<double> differences;
  for (int64_t scene = 0; scene < data.scenes(); ++scene) {
    std::vector<Tensor> background;
    for (const Tensor& all : data.backgrounds) background.push_back(all.slice(0, scene, scene + 1));
    differences.push_back(difference(background, medians));
  }
  return std::ranges::min_element(differences) - differences.begin();
}

}  // namespace engram::training
