// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "server/client/memory_client.h"
#include "server/robot/memory_server.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::testing {

/// A memory server in this process, at a socket in a folder of its own.
class RunningServer {
 public:
  RunningServer() {
    options.service.name = "test";
    options.service.memory.mode = ltm::StoreMode::kLatest;
    options.rpc.endpoints = {*server::Endpoint::parse(endpoint())};
  }

  [[nodiscard]] std::string endpoint() const { return "unix:" + (folder.path() / "s").string(); }
  [[nodiscard]] std::filesystem::path store() const { return folder.path() / "store.engram"; }

  /// What leaves memory goes to a store.
  void with_store() {
    options.service.memory.mode = ltm::StoreMode::kWhatLeaves;
    options.service.store.emplace();
    options.service.store->store = store();
    options.service.store->recording.store.min_free_bytes = 0;
  }

  void start() {
    auto started = server::MemoryServer::start(options, nullptr);
    ASSERT_TRUE(started.ok()) << started.status().to_string();
    server = *std::move(started);
  }

  [[nodiscard]] std::unique_ptr<server::MemoryClient> client(
      const server::ClientOptions& with = {}) const {
    auto made = server::MemoryClient::connect(endpoint(), with);
    EXPECT_TRUE(made.ok()) << made.status().to_string();
    return *std::move(made);
  }

  static ltm::Commit commit(const std::string& entity, int64_t at, idf::Data data = int64_t{7}) {
    return {{{*ltm::MemoryId::parse(entity), time_from_ns(at), {{std::move(data), {}}}}}};
  }

  ScratchDirectory folder;
  server::MemoryServer::Options options;
  std::unique_ptr<server::MemoryServer> server;
};

}  // namespace engram::testing
