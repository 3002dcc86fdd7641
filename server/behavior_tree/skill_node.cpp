// SPDX-License-Identifier: Apache-2.0
#include "server/behavior_tree/skill_node.h"

#include <algorithm>
#include <array>

#include "ltm/core/time.h"
#include "ltm/idf/json.h"

namespace engram::behavior_tree {

namespace {

constexpr const char* kSkill = "skill";
constexpr const char* kParameters = "parameters";
constexpr const char* kWait = "skill_wait";
constexpr const char* kCauses = "skill_causes";
constexpr const char* kReason = "skill_reason";
constexpr const char* kResult = "skill_result";
constexpr const char* kEnd = "skill_end";

// Attributes that mean something else in the XML of a tree.
constexpr std::array kKept = {"name", "ID", "_autoremap", kWait, kCauses, kReason, kResult, kEnd};

std::string outcome_text(const skills::SkillResult& result) {
  if (result.is_refused) return "refused: " + result.refusal.reason;
  return result.end.reason;
}

/// What stands between semicolons, without the spaces around it.
std::vector<std::string> parts_of(const std::string& text) {
  constexpr const char* kSpaces = " \t\r\n";
  std::vector<std::string> parts;
  for (size_t at = 0; at < text.size();) {
    const size_t to = std::min(text.find(';', at), text.size());
    const std::string part = text.substr(at, to - at);
    const size_t first = part.find_first_not_of(kSpaces);
    if (first != std::string::npos)
      parts.push_back(part.substr(first, part.find_last_not_of(kSpaces) + 1 - first));
    at = to + 1;
  }
  return parts;
}

std::string json_of(const idf::Dict& values) {
  const auto json = idf::to_json_text(values);
  if (!json.ok()) throw BT::RuntimeError("parameters: " + json.status().message());
  return *json;
}

/// A text as the value of a parameter of this type.
idf::Data value_of(const std::string& text, const std::string& type) {
  if (type == "string" || type == "link") return text;
  // What cannot be read stays a text, which the skill memory refuses with its path.
  auto parsed = idf::from_json_text(text);
  return parsed.ok() ? *std::move(parsed) : idf::Data(text);
}

/// "times=2; text=Hello." as JSON. A text in braces is JSON already, which only a blackboard entry
/// can be: the library takes such an attribute for the name of one.
std::string listed_parameters(const std::string& text) {
  if (text.starts_with('{')) return text;
  idf::Dict values;
  for (const std::string& one : parts_of(text)) {
    const size_t equals = one.find('=');
    if (equals == std::string::npos)
      throw BT::RuntimeError("port 'parameters': found '" + one + "', needs NAME=VALUE");
    values.set(one.substr(0, equals), value_of(one.substr(equals + 1), ""));
  }
  return json_of(values);
}

}  // namespace

SkillNode::SkillNode(const std::string& name, const BT::NodeConfiguration& config, Memory& memory,
                     std::optional<NodeSkill> skill, SkillNodeOptions options)
    : StatefulActionNode(name, config),
      memory_(memory),
      skill_(std::move(skill)),
      options_(std::move(options)) {}

SkillNode::~SkillNode() = default;

BT::PortsList SkillNode::ports_of(const std::optional<NodeSkill>& skill) {
  BT::PortsList ports;
  const auto takes = [&](const std::string& name, const std::string& doc) {
    ports.insert(BT::InputPort<std::string>(name, doc));
  };
  if (skill) {
    for (const ::skill::Parameter& parameter : skill->parameters) {
      std::string doc = parameter.type;
      if (!parameter.unit.empty()) doc += ", " + parameter.unit;
      if (parameter.default_json) doc += ", default " + *parameter.default_json;
      if (!parameter.doc.empty()) doc += ". " + parameter.doc;
      takes(port_of(parameter.name), doc);
    }
  } else {
    takes(kSkill, "PROVIDER/SKILL");
    takes(kParameters, "its parameters: NAME=VALUE; NAME=VALUE, or a blackboard entry with JSON");
  }
  takes(kWait, "how long it may wait for conditions and resources, as in 5s");
  takes(kCauses, "IDs of why it is wanted, separated by semicolons");
  ports.insert(BT::OutputPort<std::string>(kReason, "how it ended, in words"));
  ports.insert(BT::OutputPort<std::string>(kResult, "what came out, as JSON"));
  ports.insert(BT::OutputPort<std::string>(kEnd, "ID of the event or refusal that says so"));
  return ports;
}

std::string SkillNode::port_of(const std::string& parameter) {
  const bool is_kept = std::ranges::find(kKept, parameter) != kKept.end();
  return is_kept ? parameter + "_" : parameter;
}

BT::NodeStatus SkillNode::onStart() {
  skills::SkillRequest request = this->request();
  {
    const MutexLock lock(mutex_);
    result_.reset();
  }
  running_ = std::jthread([this, request = std::move(request)](const std::stop_token& stop) {
    auto result = skills::run_skill(memory_, request, {}, stop, options_.answer_within);
    {
      const MutexLock lock(mutex_);
      result_ = std::move(result);
    }
#if ENGRAM_BEHAVIOR_TREE_WAKES
    // A tree that sleeps between ticks goes on at once.
    emitWakeUpSignal();
#endif
  });
  return BT::NodeStatus::RUNNING;
}

BT::NodeStatus SkillNode::onRunning() {
  {
    const MutexLock lock(mutex_);
    if (!result_) return BT::NodeStatus::RUNNING;
  }
  running_.join();
  const MutexLock lock(mutex_);
  return end(*result_);
}

void SkillNode::onHalted() {
  running_.request_stop();
  if (running_.joinable()) running_.join();
  const MutexLock lock(mutex_);
  if (result_) end(*result_);
}

BT::NodeStatus SkillNode::end(const Result<skills::SkillResult>& result) {
  if (!result.ok()) {
    tell(kReason, result.status().message());
    return BT::NodeStatus::FAILURE;
  }
  tell(kReason, outcome_text(*result));
  tell(kEnd, result->end_id.to_string());
  if (result->is_refused) return BT::NodeStatus::FAILURE;
  tell(kResult, result->end.result);
  return result->end.outcome == ::skill::Outcome::SUCCESS ? BT::NodeStatus::SUCCESS
                                                          : BT::NodeStatus::FAILURE;
}

skills::SkillRequest SkillNode::request() {
  skills::SkillRequest request{.requester = options_.requester, .causes = options_.causes};
  if (skill_) {
    request.skill = skill_->name;
    request.parameters_json = parameters_json();
  } else {
    const auto skill = input(kSkill);
    if (!skill) throw BT::RuntimeError(name() + ": port 'skill' is not set, needs PROVIDER/SKILL");
    request.skill = *skill;
    request.parameters_json = listed_parameters(input(kParameters).value_or(""));
  }
  if (const auto wait = input(kWait)) {
    const auto duration = parse_duration(*wait);
    if (!duration.ok())
      throw BT::RuntimeError(name() + ": port 'skill_wait': " + duration.status().message());
    request.wait = *duration;
  }
  for (const std::string& cause : parts_of(input(kCauses).value_or(""))) {
    const auto id = ltm::MemoryId::parse(cause);
    if (!id.ok())
      throw BT::RuntimeError(name() + ": port 'skill_causes': " + id.status().message());
    request.causes.push_back(*id);
  }
  return request;
}

std::optional<std::string> SkillNode::input(const std::string& port) {
  const auto& set = config().input_ports;
  if (set.find(port) == set.end()) return std::nullopt;
  const auto text = getInput<std::string>(port);
  if (!text) throw BT::RuntimeError(name() + ": port '" + port + "': " + text.error());
  return *text;
}

std::string SkillNode::parameters_json() {
  idf::Dict values;
  for (const ::skill::Parameter& parameter : skill_->parameters)
    if (const auto text = input(port_of(parameter.name)))
      values.set(parameter.name, value_of(*text, parameter.type));
  return json_of(values);
}

void SkillNode::tell(const std::string& port, const std::string& text) {
  // Nobody has to take it.
  const auto& set = config().output_ports;
  if (set.find(port) == set.end()) return;
  if (const auto told = setOutput(port, text); !told)
    throw BT::RuntimeError(name() + ": port '" + port + "': " + told.error());
}

}  // namespace engram::behavior_tree
