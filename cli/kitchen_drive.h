// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "memory/memory.h"
#include "server/access/endpoint.h"
#include "server/client/skill_provider.h"

namespace engram::cli {

/// Navigation of the live kitchen: its cost map, and the skill `drive` around what is in the way.
///
/// Owns: a thread that keeps the map up to date.
/// Threading: one thread.
class KitchenNavigation {
 public:
  /// `memory` must outlive it. Returns once the first map is committed.
  /// Errors: those of navigation::CostMapProvider::start.
  static Result<std::unique_ptr<KitchenNavigation>> start(Memory& memory);
  virtual ~KitchenNavigation() = default;

  /// Adds the skill `drive`, whose body is reached at `bus`. The provider must not outlive this.
  /// Errors: those of SkillProvider::add.
  virtual Status add_to(SkillProvider& provider, const server::Endpoint& bus) = 0;
};

}  // namespace engram::cli
