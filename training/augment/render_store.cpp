// SPDX-License-Identifier: Apache-2.0
#include "training/augment/render_store.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "training/augment/snapshot_changer.h"

namespace engram::training {

namespace {

using augmentation::Blender;
using augmentation::PartPose;
using augmentation::Recipe;
using augmentation::Scene;
using augmentation::SceneCamera;
using augmentation::SceneChangeKind;
using datasets::RememberedScene;

idf::NdArray enlarged(const idf::NdArray& image, const SceneCamera& to) {
  const auto bytes = image.bytes();
  const cv::Mat small(static_cast<int>(image.shape()[0]), static_cast<int>(image.shape()[1]),
                      CV_8UC3, const_cast<std::byte*>(bytes.data()));
  if (small.cols == to.width && small.rows == to.height) return image;
  cv::Mat large;
  cv::resize(small, large, {to.width, to.height}, 0, 0, cv::INTER_LINEAR);
  return idf::NdArray::take<uint8_t>({large.rows, large.cols, 3}, {large.datastart, large.dataend});
}

class SceneRenderer final : public SnapshotChanger {
 public:
  SceneRenderer(ltm::StoreReader& reader, const RenderOptions& options,
                datasets::SceneSource& scenes, Blender& blender)
      : reader_(reader), options_(options), scenes_(scenes), blender_(blender) {}

  std::string begin(const ltm::MemoryId& entity) override {
    entity_ = entity;
    last_period_.reset();
    return {};
  }

  Status change(const datasets::SnapshotCursor::Step& step, ltm::EntityUpdate& update,
                AugmentedEntity& report) override {
    if (!is_chosen(step.entry.time)) return {};
    if (!step.entry.recorded) {
      ++report.left_out;
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot origin, reader_.read_recorded(entity_, step.entry));
    const std::vector<int32_t> asked = asked_instances(step, origin.instances.size());
    std::vector<RememberedScene> remembered;
    for (const int32_t i : asked) {
      // Augmented snapshots are not changed again, because an origin must be a recorded snapshot.
      if (origin.is_augmented()) break;
      ENGRAM_ASSIGN_OR_RETURN(auto scene, scenes_.scene(reader_, origin, static_cast<size_t>(i)));
      if (!scene) break;
      remembered.push_back(*std::move(scene));
    }
    if (asked.empty() || remembered.size() < asked.size()) {
      ++report.left_out;
      report.without_scene += origin.is_augmented() ? 0 : 1;
      return {};
    }
    for (int copy = 0; copy < options_.copies; ++copy)
      for (const SceneChangeKind kind : options_.kinds)
        ENGRAM_RETURN_IF_ERROR(append(origin, asked, remembered, kind, copy, update));
    last_period_ = part_of(origin.time, options_.every);
    return {};
  }

 private:
  [[nodiscard]] bool is_chosen(Time time) const {
    if (options_.every == Duration::zero()) return true;
    const int64_t period = part_of(time, options_.every);
    return period != last_period_ ||
           time - time_from_ns(period * options_.every.count()) < options_.hold;
  }

  /// Adds one image for each of the instances, all with the same change.
  Status append(const ltm::Snapshot& origin, const std::vector<int32_t>& asked,
                const std::vector<RememberedScene>& remembered, SceneChangeKind kind, int copy,
                ltm::EntityUpdate& update) {
    const auto change = scene_recipe_at(options_, kind, remembered.front(), origin.time, copy);
    if (!change) return {};
    const PartPose rig = remembered.front().scene.camera.pose;
    for (size_t i = 0; i < asked.size(); ++i) {
      Scene scene = remembered[i].scene;
      ENGRAM_RETURN_IF_ERROR(augmentation::change_scene(scene, change->changes.front(), rig));
      const SceneCamera camera = scene.camera;
      // Rendering is slow (1.7 s for 320 x 240 pixels on two cores), so large images are rendered
      // smaller and enlarged.
      scene.camera = augmentation::scaled_down(camera, options_.width);
      Recipe recipe = *change;
      recipe.changes.push_back(how_rendered(scene.camera.width));
      const auto rendered = blender_.render(scene);
      const ltm::MemoryId id = origin.id().instance(asked[i]);
      if (!rendered.ok()) return rendered.status().with_context(id.to_string());
      ENGRAM_ASSIGN_OR_RETURN(
          auto data, scenes_.seen(origin.instances[static_cast<size_t>(asked[i])].data, camera,
                                  enlarged(*rendered, camera)));
      ENGRAM_ASSIGN_OR_RETURN(auto metadata, augmented_metadata(origin, asked[i], recipe));
      update.instances.push_back({std::move(data), std::move(metadata)});
    }
    return {};
  }

  [[nodiscard]] augmentation::Change how_rendered(int width) const {
    const auto noise = static_cast<int64_t>(std::llround(options_.blender.noise * 1000));
    return {"render", idf::Dict{{"program", "Blender " + blender_.version()},
                                {"samples", int64_t{options_.blender.samples}},
                                {"noise_permille", noise},
                                {"width", int64_t{width}}}};
  }

  ltm::StoreReader& reader_;
  const RenderOptions& options_;
  datasets::SceneSource& scenes_;
  Blender& blender_;
  ltm::MemoryId entity_;
  std::optional<int64_t> last_period_;  ///< The last period in which something was rendered.
};

}  // namespace

Status RenderOptions::validate() const {
  ENGRAM_RETURN_IF_ERROR(AugmentedStoreOptions::validate());
  if (kinds.empty()) return invalid_argument("rendering: found no change, needs one");
  if (every < Duration::zero())
    return invalid_argument("rendering every: found {}, needs 0 or more", to_string(every));
  if (width < 16 || width > 4096)
    return invalid_argument("rendering: found a width of {}, needs 16 to 4096", width);
  return {};
}

std::optional<Recipe> scene_recipe_at(const RenderOptions& options, SceneChangeKind kind,
                                      const RememberedScene& scene, Time time, int copy) {
  augmentation::Random random(seed_of(options.seed, SeedPurpose::kScene,
                                      copy * 16 + static_cast<int>(kind),
                                      part_of(time, options.hold)));
  const auto change = augmentation::draw_scene_change(kind, scene.scene, scene.things_in_sight,
                                                      options.strength_percent, random);
  if (!change) return std::nullopt;
  return Recipe{{*change}};
}

Result<AugmentReport> render_store(const std::filesystem::path& from,
                                   const std::filesystem::path& to, const RenderOptions& options,
                                   datasets::SceneSource& scenes, const ProgressSink& progress,
                                   const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(from));
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, entities_of(*reader, options.query));
  ENGRAM_ASSIGN_OR_RETURN(const auto blender, Blender::start(options.blender));
  SceneRenderer renderer(*reader, options, scenes, *blender);
  return make_augmented_store(*reader, to, entities, options, renderer, progress, stop);
}

}  // namespace engram::training
