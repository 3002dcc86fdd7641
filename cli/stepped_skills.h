// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "datasets/kitchen/body_steps.h"
#include "server/client/skill_provider.h"

namespace engram::cli {

/// A provider whose executions take part in the steps of a body: from the moment at which one is
/// taken up, time passes only while its bus waits.
///
/// Threading: thread-safe.
/// Source: docs/kitchen.md, section "Steps".
class SteppedProvider final : public SkillProvider {
 public:
  /// `steps` must outlive it.
  SteppedProvider(std::unique_ptr<SkillProvider> provider, datasets::kitchen::BodySteps& steps)
      : steps_(steps), provider_(std::move(provider)) {}

  Status add(std::string_view description, SkillFunction function) override;
  Status remove(const std::string& skill) override { return provider_->remove(skill); }
  [[nodiscard]] size_t running() const override { return provider_->running(); }

  /// Adds the skill `pass`, which lets held time pass. Errors: those of SkillProvider::add.
  Status add_pass();

 private:
  SkillEnd pass(SkillRun& run);

  datasets::kitchen::BodySteps& steps_;
  std::atomic<size_t> taken_up_{0};  ///< Executions that run, but those of `pass`.
  std::atomic<uint64_t> passes_{0};
  const std::unique_ptr<SkillProvider> provider_;  ///< It ends first, and with it what runs.
};

}  // namespace engram::cli
