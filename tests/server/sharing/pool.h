// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "server/sharing/shared_pool.h"

namespace engram::testing {

inline constexpr server::ClientId kWriter = 1;
inline constexpr server::ClientId kReader = 2;
inline constexpr server::ClientId kOther = 3;
inline constexpr server::GroupId kGroup = 7;
inline constexpr size_t kMiB = size_t{1} << 20;

/// A pool with a writer and others that may read what it writes. Without processes: what a writer
/// would map is sealed at once.
class Pool {
 public:
  explicit Pool(const server::SharedPool::Options& options = {})
      : pool_(std::move(*server::SharedPool::create(options))) {
    for (const server::ClientId client : {kWriter, kReader, kOther})
      EXPECT_TRUE(pool_->add_client(client).ok());
    EXPECT_TRUE(pool_->grant_read(kReader, kGroup).ok());
  }

  server::SharedPool* operator->() { return pool_.get(); }
  void destroy() { pool_.reset(); }

  server::BlockRef lease(size_t bytes, server::ClientId writer = kWriter,
                         server::GroupId group = kGroup) {
    const auto block = pool_->lease(writer, group, bytes);
    EXPECT_TRUE(block.ok()) << block.status().to_string();
    if (!block.ok()) return {};
    const Status sealed =
        writer == server::kServerItself ? Status() : pool_->seal(writer, block->slab);
    EXPECT_TRUE(sealed.ok()) << sealed.to_string();
    return *block;
  }

  Buffer commit(const server::BlockRef& block, server::ClientId writer = kWriter,
                server::GroupId group = kGroup) {
    const auto buffer = pool_->commit(writer, group, block, block.capacity);
    EXPECT_TRUE(buffer.ok()) << buffer.status().to_string();
    return buffer.value_or(Buffer());
  }

 private:
  std::unique_ptr<server::SharedPool> pool_;
};

/// Limits that tests reach soon.
inline server::SharedPool::Options small() {
  server::SharedPool::Options options;
  options.max_bytes = 4 * kMiB;
  options.max_writer_bytes = 2 * kMiB;
  options.first_slab_bytes = kMiB;
  options.slab_bytes = kMiB;
  return options;
}

inline StatusCode code_of(const Status& status) {
  return status.code();
}
template <typename T>
StatusCode code_of(const Result<T>& result) {
  return result.status().code();
}

}  // namespace engram::testing
