// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "server/names/name_registry.h"
#include "tests/ltm/expect_status.h"

namespace engram::testing {

/// A name registry whose time the test sets.
class PlainRegistry {
 public:
  static constexpr uint64_t kRegistry = 7;

  explicit PlainRegistry(const server::NameRegistry::Options& options = {})
      : registry_(std::move(*server::NameRegistry::create(
            options, kRegistry, [this] { return SteadyTime(Duration(now_.load())); }))) {}

  server::NameRegistry* operator->() const { return registry_.get(); }

  void pass(Duration duration) { now_ += duration.count(); }

  static server::Registration server(std::string name, std::vector<std::string> memories,
                                     uint64_t incarnation = 1) {
    const std::string endpoint = "unix:/run/" + name + ".sock";
    return {std::move(name), std::move(memories), {endpoint}, incarnation};
  }

  /// Who holds a memory; empty where nobody does.
  [[nodiscard]] std::string holder(std::string_view memory) const {
    const auto found = registry_->find(memory);
    return found.ok() ? found->server : "";
  }

 private:
  std::atomic<int64_t> now_{1'000'000'000};
  std::unique_ptr<server::NameRegistry> registry_;
};

}  // namespace engram::testing
