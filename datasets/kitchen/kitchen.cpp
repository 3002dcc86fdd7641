// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen.h"

#include "datasets/kitchen/episode.h"
#include "datasets/kitchen/kitchen_layout.h"
#include "datasets/kitchen/renderer.h"
#include "datasets/kitchen/thing_colours.h"

namespace engram::datasets {

namespace {

constexpr int kMinSide = 32;
constexpr int kMaxSide = 1024;
constexpr double kMaxSeconds = 3600;
constexpr int kFastSide = 128;

bool is_side(int pixels) {
  return pixels >= kMinSide && pixels <= kMaxSide && pixels % 2 == 0;
}

}  // namespace

KitchenOptions KitchenOptions::fast() {
  return {.width = kFastSide, .height = kFastSide, .is_fine = false};
}

Status KitchenOptions::validate() const {
  if (!is_side(width) || !is_side(height))
    return invalid_argument("kitchen: size {} x {}, needs even numbers of {} to {}", width, height,
                            kMinSide, kMaxSide);
  if (!(seconds >= 1) || seconds > kMaxSeconds)
    return invalid_argument("kitchen: {} seconds, needs 1 to {}", seconds, kMaxSeconds);
  if (records_depth && !has_images)
    return invalid_argument("kitchen: depth without images; it is the depth of an image");
  const std::chrono::years since_1970 =
      std::chrono::floor<std::chrono::years>(start.time_since_epoch());
  if (since_1970.count() < 0 || since_1970.count() >= 230)
    return invalid_argument("kitchen: starts at {}, needs a time from 1970 to 2199",
                            to_string(start));
  return {};
}

kitchen::DrawingSize kitchen::drawing_size(const KitchenOptions& options) {
  return {.width = options.width,
          .height = options.height,
          .samples = options.is_fine ? 4 : 0,
          .shadow_map = options.is_fine ? 2048 : 0,
          .is_painted = options.has_images};
}

Result<KitchenSummary> simulate_kitchen(const KitchenOptions& options, const CommitSink& sink,
                                        const ProgressSink& progress) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  const kitchen::DrawingSize size = kitchen::drawing_size(options);
  kitchen::Layout layout = kitchen::make_layout(options.seed);
  if (options.has_colours) kitchen::give_colours(layout);
  ENGRAM_ASSIGN_OR_RETURN(kitchen::World world, kitchen::World::create(layout, size));
  std::unique_ptr<kitchen::Renderer> renderer;
  if (options.has_images) {
    ENGRAM_ASSIGN_OR_RETURN(renderer, kitchen::Renderer::create(world, size));
  }
  kitchen::Reporter reporter(options, size, world, renderer.get(), sink);
  kitchen::Episode episode(options, world, reporter, progress);
  ENGRAM_RETURN_IF_ERROR(episode.run());
  KitchenSummary summary = episode.summary();
  summary.raw_bytes = reporter.raw_bytes();
  return summary;
}

}  // namespace engram::datasets
