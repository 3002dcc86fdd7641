// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/skills/skill_types.h"
#include "memory/memory.h"
#include "server/skills/condition_state.h"

namespace engram::skills {

/// What somebody asks of a skill.
struct SkillRequest {
  std::string skill;  ///< "PROVIDER/SKILL", or "SKILL" if only one provider has it.
  std::string parameters_json = "{}";   ///< The parameters that are given.
  std::string requester = "program";    ///< Who asks: a name of a provider segment.
  Duration wait{};                      ///< How long it may wait for conditions and resources.
  std::string version{};                ///< The version that is needed; empty: any.
  std::vector<ltm::MemoryId> causes{};  ///< Why it is asked for.
};

/// How a request ended.
struct SkillResult {
  ltm::MemoryId request;  ///< Its instance.
  bool is_refused = false;
  ::skill::Refusal refusal;  ///< If it was refused.
  ::skill::Event end;        ///< If it was executed.
  ltm::MemoryId end_id;      ///< The instance of the end, or of the refusal.
};

/// Asks for a skill and waits until it has ended. `on_event` is told of its start and of what it
/// reports, by a thread of the memory. If `stop` is requested, the execution is stopped, and its
/// end is waited for.
/// Errors: those of Memory::subscribe and commit; kUnavailable if there was no answer for
/// `answer_within` although nothing runs: there is no skill memory.
Result<SkillResult> run_skill(Memory& memory, const SkillRequest& request,
                              const std::function<void(const ::skill::Event&)>& on_event,
                              const std::stop_token& stop = {},
                              Duration answer_within = std::chrono::seconds(10));

/// Asks for something else of a skill: to stop what runs or waits of it (`execution`: the event at
/// which it started, or its request; else all), or to switch it off or on. Returns the request.
/// Errors: those of Memory::commit.
Result<ltm::MemoryId> ask_skill(Memory& memory, const std::string& skill, ::skill::Wish wish,
                                const std::string& requester,
                                const std::optional<ltm::MemoryId>& execution = {});

/// One condition of a skill as it is now.
struct ConditionNow {
  std::string name;  ///< "pre", "hold", "post" or "when".
  std::string text;
  bool is_met = false;
  std::vector<Unmet> unmet;
};

/// A skill as the memory knows it now.
struct SkillNow {
  ltm::MemoryId id;  ///< The instance that describes it.
  ::skill::Executable executable;
  std::vector<ConditionNow> conditions;       ///< Those that need no parameters, or have them.
  std::vector<std::string> needs_parameters;  ///< Names of the conditions that do.
  std::optional<::skill::Event> last_event;
  std::optional<::skill::Refusal> last_refusal;
};

/// All skills that the memory knows, in the order of their names.
/// Errors: those of Memory::query.
Result<std::vector<std::pair<ltm::MemoryId, ::skill::Executable>>> list_skills(Memory& memory);

/// What a skill is, and why it would not start now. With `parameters_json` conditions that name
/// parameters are told, too.
/// Errors: kNotFound; kInvalidArgument if parameters do not fit; those of Memory::query.
Result<SkillNow> explain_skill(Memory& memory, const std::string& skill,
                               const std::optional<std::string>& parameters_json);

}  // namespace engram::skills
