// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/told_events.h"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>

namespace engram::ltm {

namespace {

constexpr std::array kSpeechNames{"text", "words", "utterance", "transcript", "sentence"};
constexpr std::array kOutcomeNames{"outcome", "status", "result", "success", "succeeded"};
constexpr int kMaxToldDepth = 64;

void read_texts(const idf::Data& value, std::string_view name, int depth, ToldEvents& told) {
  if (depth > kMaxToldDepth) return;
  if (const auto* dict = value.get_if<idf::Dict>()) {
    for (const idf::DictEntry& entry : *dict) read_texts(entry.value, entry.key, depth + 1, told);
  } else if (const auto* list = value.get_if<idf::List>()) {
    for (const idf::Data& element : *list) read_texts(element, "[]", depth + 1, told);
  } else if (const auto* text = value.get_if<std::string>()) {
    if (const auto entity = linked_entity(*text))
      told.links = mixed_text(mixed_text(told.links + 1, name), entity->to_string());
    else if (!text->empty() && is_speech_member(name))
      told.is_speech = true;
  }
}

}  // namespace

uint64_t mixed_text(uint64_t before, std::string_view text) {
  return (std::rotl(before, 23) ^ std::hash<std::string_view>{}(text)) * 0x9e3779b97f4a7c15ULL;
}

bool is_speech_member(std::string_view path) {
  const size_t slash = path.rfind('/');
  const auto name = slash == std::string_view::npos ? path : path.substr(slash + 1);
  return path.empty() || std::ranges::find(kSpeechNames, name) != kSpeechNames.end();
}

std::optional<MemoryId> linked_entity(const std::string& text) {
  if (std::ranges::count(text, '/') < 3) return std::nullopt;
  const auto id = MemoryId::parse(text);
  return id.ok() && id->has_entity() ? std::optional(id->entity()) : std::nullopt;
}

ActionOutcome outcome_in(const idf::Data& value, const std::optional<idf::Type>& type) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return ActionOutcome::kUnknown;
  for (const char* const name : kOutcomeNames) {
    const idf::Data* const found = dict->find(name);
    if (found == nullptr) continue;
    const ActionOutcome outcome = outcome_of(*found, name, type);
    if (outcome != ActionOutcome::kUnknown) return outcome;
  }
  return ActionOutcome::kUnknown;
}

ToldEvents told_events(const idf::Data& value, const std::optional<idf::Type>& type) {
  ToldEvents told;
  told.outcome = outcome_in(value, type);
  read_texts(value, "", 0, told);
  return told;
}

}  // namespace engram::ltm
