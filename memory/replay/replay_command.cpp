// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/replay_command.h"

#include <array>
#include <string>

namespace engram {

namespace {

using Kind = ReplayCommand::Kind;

struct KindName {
  Kind kind;
  std::string_view name;
};

constexpr std::array<KindName, 6> kKinds{{{Kind::kPlay, "play"},
                                          {Kind::kPause, "pause"},
                                          {Kind::kStep, "step"},
                                          {Kind::kSeek, "seek"},
                                          {Kind::kSpeed, "speed"},
                                          {Kind::kLoop, "loop"}}};

std::string kind_names() {
  std::string names;
  for (const KindName& one : kKinds)
    names += (names.empty() ? "" : ", ") + ("'" + std::string(one.name) + "'");
  return names;
}

Result<Time> time_of(const idf::Data& data, std::string_view key) {
  const idf::Data* found = data.at(key);
  if (found != nullptr) {
    if (const auto* text = found->get_if<std::string>()) return parse_time(*text);
    if (const auto* ns = found->get_if<int64_t>()) return time_from_ns(*ns);
    if (const auto* ns = found->get_if<int32_t>()) return time_from_ns(*ns);
  }
  return invalid_argument("replay command: '{}' is {}, needs a time: text, or ns as an integer",
                          key, found == nullptr ? "missing" : std::string(found->kind_name()));
}

}  // namespace

Status ReplayCommand::validate() const {
  if (kind == Kind::kSpeed) return check_replay_speed(speed);
  if (kind == Kind::kLoop && loop) return loop->validate();
  return {};
}

idf::Data ReplayCommand::to_data() const {
  idf::Dict data{{"command", std::string(to_string(kind))}};
  if (kind == Kind::kSeek) data.set("time", to_ns(time));
  if (kind == Kind::kSpeed) data.set("speed", speed);
  if (kind == Kind::kLoop && loop) {
    data.set("first", to_ns(loop->first));
    data.set("last", to_ns(loop->last));
  }
  return data;
}

Result<ReplayCommand> ReplayCommand::from_data(const idf::Data& data) {
  const idf::Data* word = data.is<idf::Dict>() ? data.at("command") : nullptr;
  const auto* name = word == nullptr ? nullptr : word->get_if<std::string>();
  if (name == nullptr)
    return invalid_argument("replay command: has no text 'command', needs one of {}", kind_names());
  ReplayCommand command;
  bool is_known = false;
  for (const KindName& one : kKinds) {
    if (one.name != *name) continue;
    command.kind = one.kind;
    is_known = true;
  }
  if (!is_known)
    return invalid_argument("replay command: found '{}', needs one of {}", *name, kind_names());
  if (command.kind == Kind::kSeek) {
    ENGRAM_ASSIGN_OR_RETURN(command.time, time_of(data, "time"));
  }
  if (command.kind == Kind::kSpeed) {
    const idf::Data* speed = data.at("speed");
    const auto number = speed == nullptr ? std::nullopt : speed->as_number();
    if (!number) return invalid_argument("replay command: has no number 'speed', needs one");
    command.speed = *number;
  }
  if (command.kind == Kind::kLoop && (data.at("first") != nullptr || data.at("last") != nullptr)) {
    ReplayLoop loop;
    ENGRAM_ASSIGN_OR_RETURN(loop.first, time_of(data, "first"));
    ENGRAM_ASSIGN_OR_RETURN(loop.last, time_of(data, "last"));
    command.loop = loop;
  }
  ENGRAM_RETURN_IF_ERROR(command.validate());
  return command;
}

std::string_view to_string(ReplayCommand::Kind kind) {
  for (const KindName& one : kKinds)
    if (one.kind == kind) return one.name;
  return "";
}

const ltm::MemoryId& replay_control_entity() {
  static const ltm::MemoryId id =
      *ltm::MemoryId::from_names({"SystemState", "Replay", "engram", "control"});
  return id;
}

ltm::Commit commit_of(const ReplayCommand& command) {
  const Time now = system_now();
  return {{{replay_control_entity(),
            now,
            {{command.to_data(), {.created = now, .sent = now, .provider = "engram"}}}}}};
}

}  // namespace engram
