// SPDX-License-Identifier: Apache-2.0
#include "training/fit/scenes.h"

#include <algorithm>
#include <cstring>

namespace engram::training {

using torch::Tensor;

namespace {

/// Max number of evenly spaced images of a median, and of those of large images.
constexpr size_t kMaxMedianImages = 64;
constexpr size_t kMaxLargeMedianImages = 15;
/// Max pixels of the images of a median, which are in memory twice as floats.
constexpr size_t kMaxMedianPixels = size_t{1} << 21;
/// Recordings whose medians differ by less on average share a background. Unit: grey levels.
constexpr double kAlike = 3.0;
constexpr size_t kMaxScenes = 16;

/// The median image of a sequence per member. Shape: [1, C, H, W].
std::vector<Tensor> medians_of(const Dataset& data, const encoders::NetworkShape& shape,
                               const Sequence& sequence) {
  size_t pixels = 1;
  for (const auto& image : shape.images)
    pixels = std::max(pixels, static_cast<size_t>(image.height * image.width));
  const size_t max_images =
      std::clamp(kMaxMedianPixels / pixels, kMaxLargeMedianImages, kMaxMedianImages);
  const size_t step = (sequence.size() + max_images - 1) / max_images;
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
Result<Tensor> coded(const encoders::ImageMember& member, const Tensor& backgrounds,
                     const std::stop_token& stop) {
  if (member.is_depth) return Tensor();
  const auto scenes = backgrounds.size(0);
  Tensor all = torch::empty({static_cast<int64_t>(encoders::kBackgroundQualities) * scenes,
                             member.height, member.width, member.channels},
                            torch::kUInt8);
  int64_t at = 0;
  for (size_t quality = 0; quality < encoders::kBackgroundQualities; ++quality)
    for (int64_t scene = 0; scene < scenes; ++scene, ++at) {
      if (stop.stop_requested()) return cancelled("training was stopped");
      const auto image = encoders::to_image_array(member, backgrounds.slice(0, scene, scene + 1));
      const auto one = encoders::code_background(image, quality);
      if (!one.ok() || !*one) return Tensor();
      const auto pixels = (*one)->pixels.bytes();
      std::memcpy(all.select(0, at).data_ptr(), pixels.data(), pixels.size());
    }
  return all;
}

Status code_backgrounds(Dataset& data, const std::stop_token& stop) {
  if (data.scenes() < 2) return {};
  for (size_t i = 0; i < data.backgrounds.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(Tensor all, coded(data.plan.images()[i], data.backgrounds[i], stop));
    data.coded_backgrounds.push_back(std::move(all));
    if (data.coded_backgrounds.back().defined()) continue;
    data.coded_backgrounds.clear();
    return {};
  }
  return {};
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

Status find_scenes(Dataset& data, const encoders::DeepModel* start, const std::stop_token& stop) {
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
    if (stop.stop_requested()) return cancelled("training was stopped");
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
  return code_backgrounds(data, stop);
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
