// SPDX-License-Identifier: Apache-2.0
#pragma once

// A server with sensory memory of images, its provider, and who is told of them.

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <vector>

#include "tests/ltm/expect_status.h"
#include "tests/server/robot/running_server.h"
#include "tests/server/robot/sensory_images.h"

namespace engram::server {

using namespace std::chrono_literals;
using testing::image_commit;
using testing::is_whole_image;
using testing::kLeft;
using testing::kRight;
using testing::RunningServer;

/// Collects what a subscriber is told, and whether all of it was whole.
class ToldImages {
 public:
  SubscriptionHandlers handlers() {
    SubscriptionHandlers made;
    made.on_snapshots = [this](const std::vector<ToldSnapshot>& told) {
      const std::scoped_lock lock(mutex_);
      for (const ToldSnapshot& one : told) {
        const int64_t at = to_ns(one.snapshot.time);
        times_.push_back(at);
        if (!one.has_data || !is_whole_image(one.snapshot.instances[0].data, at)) ++broken_;
      }
      changed_.notify_all();
    };
    return made;
  }

  std::vector<int64_t> wait_for(size_t count) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, 10s, [&] { return times_.size() >= count; }))
        << times_.size() << " came";
    return times_;
  }

  int broken() {
    const std::scoped_lock lock(mutex_);
    return broken_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<int64_t> times_;
  int broken_ = 0;
};

class Sensory : public ::testing::TestWithParam<bool> {
 protected:
  void start(Duration hold = 10s) {
    auto& sensory = running_.options.service.sensory;
    sensory.segments = {{*ltm::MemoryId::parse("Vision/RGB"), hold}};
    sensory.query_attention = 30ms;
    running_.options.service.store_interval = 20ms;
    running_.start();
    client_ = running_.client({.shares_memory = shares()});
  }

  /// Whether the client shares memory; without it the server holds what it sends.
  [[nodiscard]] static bool shares() {
    return ::testing::UnitTest::GetInstance()->current_test_info()->value_param() == nullptr ||
           GetParam();
  }

  Status commit(const std::string& entity, int64_t at, size_t bytes = 20'000) {
    return client_->commit(image_commit(entity, at, bytes));
  }

  std::vector<int64_t> ask(const std::string& text) {
    const auto result = running_.client()->query(*ltm::Query::parse(text));
    EXPECT_OK(result);
    std::vector<int64_t> times;
    if (!result.ok()) return times;
    for (const ltm::EntityResult* entity : result->entities())
      for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
        times.push_back(to_ns(snapshot.time));
        EXPECT_TRUE(is_whole_image(snapshot.instances[0].data, times.back()));
      }
    return times;
  }

  memory::MemoryService::Counters counters() { return running_.server->service().counters(); }
  memory::SensoryCounts counts() { return *counters().sensory; }

  RunningServer running_;
  std::unique_ptr<MemoryClient> client_;
};

}  // namespace engram::server
