// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "server/client/names_client.h"
#include "server/rpc/names_rpc.h"
#include "server/rpc/rpc_server.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::testing {

/// A name system in this process, at a socket in a folder of its own; it can be started again.
class RunningNames {
 public:
  [[nodiscard]] std::string endpoint() const { return "unix:" + (folder.path() / "n").string(); }

  void start() {
    auto registry = server::NameRegistry::create(options, ++starts_);
    ASSERT_TRUE(registry.ok()) << registry.status().to_string();
    registry_ = *std::move(registry);
    rpc_ = server::make_names_rpc(*registry_, access);
    server::RpcServer::Options listening;
    listening.endpoints = {*server::Endpoint::parse(endpoint())};
    auto started = server::RpcServer::start(listening, {rpc_.get()});
    ASSERT_TRUE(started.ok()) << started.status().to_string();
    server_ = *std::move(started);
  }

  void stop() {
    server_.reset();
    rpc_.reset();
    registry_.reset();
  }

  [[nodiscard]] std::unique_ptr<server::NamesClient> client(
      const server::ClientOptions& with = {}) const {
    auto made = server::NamesClient::connect(endpoint(), with);
    EXPECT_TRUE(made.ok()) << made.status().to_string();
    return *std::move(made);
  }

  ScratchDirectory folder;
  server::NameRegistry::Options options;
  server::AccessPolicy access = server::AccessPolicy::everyone();

 private:
  uint64_t starts_ = 0;
  std::unique_ptr<server::NameRegistry> registry_;
  std::unique_ptr<grpc::Service> rpc_;
  std::unique_ptr<server::RpcServer> server_;
};

}  // namespace engram::testing
