// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/stage.h"

#include <sys/resource.h>

#include <deque>
#include <future>
#include <thread>
#include <utility>

#include "datasets/kitchen/renderer.h"
#include "ltm/core/mutex.h"

namespace engram::datasets::kitchen {

namespace {

struct DrawingOrder {
  std::vector<double> coordinates;
  uint64_t sample = 0;
  std::promise<BodyPicture> picture;
};

}  // namespace

struct Stage::Parts {
  explicit Parts(World twin) : world(std::move(twin)) {}

  /// OpenGL's context belongs to the thread that made it.
  void run(const std::stop_token& stop, const DrawingSize& size, std::promise<Status> opened) {
    // Of this thread and of those of OpenGL, which it starts: when the machine is busy, there are
    // fewer images, and the body keeps its pace.
    constexpr int kNicer = 5;
    ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + kNicer);
    auto renderer = Renderer::create(world, size);
    opened.set_value(renderer.status());
    if (!renderer.ok()) return;
    while (true) {
      DrawingOrder order;
      {
        const MutexLock lock(mutex);
        if (!condition.wait(mutex, stop,
                            [this]() ENGRAM_REQUIRES(mutex) { return !orders.empty(); }))
          return;
        order = std::move(orders.front());
        orders.pop_front();
      }
      world.set_coordinates(order.coordinates);
      StereoPicture drawn = (*renderer)->draw(world, false);
      order.picture.set_value({.sample = order.sample,
                               .left = std::move(drawn.left),
                               .right = std::move(drawn.right),
                               .pose_world_left = world.camera_pose(Side::kLeft),
                               .pose_world_right = world.camera_pose(Side::kRight)});
    }
  }

  World world;  ///< Used by the thread alone.
  Mutex mutex;
  StoppableCondition condition;
  std::deque<DrawingOrder> orders ENGRAM_GUARDED_BY(mutex);
  std::jthread thread;
};

Stage::Stage(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Stage::~Stage() = default;

Result<std::unique_ptr<Stage>> Stage::open(const World& world, const DrawingSize& size) {
  ENGRAM_ASSIGN_OR_RETURN(World twin, world.twin());
  auto parts = std::make_unique<Parts>(std::move(twin));
  std::promise<Status> opened;
  std::future<Status> is_open = opened.get_future();
  parts->thread = std::jthread(
      [raw = parts.get(), size, opened = std::move(opened)](const std::stop_token& stop) mutable {
        raw->run(stop, size, std::move(opened));
      });
  ENGRAM_RETURN_IF_ERROR(is_open.get());
  return std::unique_ptr<Stage>(new Stage(std::move(parts)));
}

BodyPicture Stage::draw(const std::vector<double>& coordinates, uint64_t sample) {
  DrawingOrder order{.coordinates = coordinates, .sample = sample, .picture = {}};
  std::future<BodyPicture> picture = order.picture.get_future();
  {
    const MutexLock lock(parts_->mutex);
    parts_->orders.push_back(std::move(order));
  }
  parts_->condition.notify_one();
  return picture.get();
}

}  // namespace engram::datasets::kitchen
