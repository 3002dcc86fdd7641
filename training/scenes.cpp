// SPDX-License-Identifier: Apache-2.0
#include "training/scenes.h"

#include <algorithm>

namespace engram::training {

using torch::Tensor;

namespace {

/// Images that a median is taken of, evenly spaced.
constexpr size_t kMostMedianImages = 64;
/// Recordings whose medians differ by less share a background. Unit: grey levels, mean.
constexpr double kAlike = 3.0;
constexpr size_t kMostScenes = 16;

/// The median image of a sequence, per member. [1, C, H, W]
std::vector<Tensor> medians_of(const Dataset& data, const encoders::NetworkShape& shape,
                               const Sequence& sequence) {
  const size_t step = (sequence.size() + kMostMedianImages - 1) / kMostMedianImages;
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

/// All scenes of a member in each quality, as they come back from the codec; undefined where none
/// takes them.
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

}  // namespace

void find_scenes(Dataset& data) {
  data.scene = torch::zeros({static_cast<int64_t>(data.size())}, torch::kLong);
  if (data.images.empty()) return;
  const auto shape = encoders::network_shape(data.plan, {});
  size_t most_scenes = kMostScenes;
  for (const auto& image : shape.images)
    most_scenes = std::min(most_scenes, static_cast<size_t>(encoders::most_scenes(image)));
  std::vector<std::vector<Tensor>> scenes;
  for (const Sequence& sequence : data.sequences) {
    const std::vector<Tensor> medians = medians_of(data, shape, sequence);
    std::vector<double> differences;
    for (const auto& scene : scenes) differences.push_back(difference(scene, medians));
    auto nearest = std::ranges::min_element(differences);
    const bool is_new =
        nearest == differences.end() || (*nearest >= kAlike && scenes.size() < most_scenes);
    const auto scene = is_new ? static_cast<int64_t>(scenes.size()) : nearest - differences.begin();
    if (is_new) scenes.push_back(medians);
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

}  // namespace engram::training
