// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/answer_value.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ltm/core/printable.h"

namespace engram::speech {

namespace {

using Json = nlohmann::ordered_json;

Json ids_json(const std::vector<ltm::MemoryId>& ids) {
  Json list = Json::array();
  for (const ltm::MemoryId& id : ids) list.push_back(id.to_string());
  return list;
}

struct WriteValue {
  Json operator()(answers::Unknown) const { return {}; }
  Json operator()(answers::YesNo answer) const { return {{"value", answer.value}}; }
  Json operator()(answers::Count answer) const { return {{"value", answer.value}}; }
  Json operator()(answers::Moment answer) const { return {{"value", to_string(answer.value)}}; }
  Json operator()(answers::Span answer) const {
    return {{"from", to_string(answer.from)}, {"to", to_string(answer.to)}};
  }
  Json operator()(answers::Seconds answer) const { return {{"value", answer.value}}; }
  Json operator()(answers::Metres answer) const { return {{"value", answer.value}}; }
  Json operator()(const answers::Names& answer) const { return {{"value", answer.value}}; }
  Json operator()(const answers::Events& answer) const {
    return {{"value", ids_json(answer.value)}};
  }
  Json operator()(const answers::Reason& answer) const {
    return {{"value", answer.value}, {"links", ids_json(answer.links)}};
  }
};

/// Members of one JSON object, read with errors that name them.
class MemberReader {
 public:
  explicit MemberReader(const Json& json) : json_(json) {}

  Result<std::string> text(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end() || !found->is_string()) return wrong(name, "a text");
    return found->get<std::string>();
  }
  Result<Time> time(const char* name) const {
    ENGRAM_ASSIGN_OR_RETURN(const std::string read, text(name));
    return parse_time(read);
  }
  Result<double> number(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end() || !found->is_number()) return wrong(name, "a number");
    const auto value = found->get<double>();
    if (!std::isfinite(value)) return wrong(name, "a finite number");
    return value;
  }
  Result<int64_t> integer(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end() || !found->is_number_integer()) return wrong(name, "an integer");
    return found->get<int64_t>();
  }
  Result<bool> flag(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end() || !found->is_boolean()) return wrong(name, "true or false");
    return found->get<bool>();
  }
  Result<std::vector<std::string>> texts(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end() || !found->is_array()) return wrong(name, "a list of texts");
    std::vector<std::string> values;
    for (const Json& one : *found) {
      if (!one.is_string()) return wrong(name, "a list of texts");
      values.push_back(one.get<std::string>());
    }
    return values;
  }
  Result<std::vector<ltm::MemoryId>> ids(const char* name) const {
    ENGRAM_ASSIGN_OR_RETURN(const std::vector<std::string> read, texts(name));
    std::vector<ltm::MemoryId> values;
    for (const std::string& one : read) {
      ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, ltm::MemoryId::parse(one));
      values.push_back(std::move(id));
    }
    return values;
  }

 private:
  [[nodiscard]] Status wrong(const char* name, const char* needed) const {
    const auto found = json_.find(name);
    return invalid_argument("answer value: member '{}' is {}, needs {}", name,
                            found == json_.end() ? "missing" : found->type_name(), needed);
  }

  const Json& json_;
};

template <typename Answer, typename Value>
Result<AnswerValue> answer_with(Result<Value> value) {
  ENGRAM_RETURN_IF_ERROR(value.status());
  return AnswerValue(Answer{*std::move(value)});
}

}  // namespace

answers::Names names_of(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return {std::move(names)};
}

std::string_view kind_of(const AnswerValue& value) {
  // In the order of the alternatives.
  constexpr std::array<std::string_view, std::variant_size_v<AnswerValue>> kKinds{
      "unknown", "yes_no", "count", "time",   "span",
      "seconds", "metres", "names", "events", "reason"};
  return kKinds.at(value.index());
}

Json to_json(const AnswerValue& value) {
  Json json{{"kind", kind_of(value)}};
  const Json members = std::visit(WriteValue{}, value);
  for (const auto& [name, member] : members.items()) json[name] = member;
  return json;
}

Result<AnswerValue> answer_value_from_json(const Json& json) {
  if (!json.is_object())
    return invalid_argument("answer value: found {}, needs an object", json.type_name());
  const MemberReader read(json);
  ENGRAM_ASSIGN_OR_RETURN(const std::string kind, read.text("kind"));
  if (kind == "unknown") return AnswerValue(answers::Unknown{});
  if (kind == "yes_no") return answer_with<answers::YesNo>(read.flag("value"));
  if (kind == "count") return answer_with<answers::Count>(read.integer("value"));
  if (kind == "time") return answer_with<answers::Moment>(read.time("value"));
  if (kind == "seconds") return answer_with<answers::Seconds>(read.number("value"));
  if (kind == "metres") return answer_with<answers::Metres>(read.number("value"));
  if (kind == "events") return answer_with<answers::Events>(read.ids("value"));
  if (kind == "names") {
    ENGRAM_ASSIGN_OR_RETURN(std::vector<std::string> names, read.texts("value"));
    return AnswerValue(names_of(std::move(names)));
  }
  if (kind == "span") {
    ENGRAM_ASSIGN_OR_RETURN(const Time from, read.time("from"));
    ENGRAM_ASSIGN_OR_RETURN(const Time to, read.time("to"));
    return AnswerValue(answers::Span{from, to});
  }
  if (kind == "reason") {
    ENGRAM_ASSIGN_OR_RETURN(std::string words, read.text("value"));
    ENGRAM_ASSIGN_OR_RETURN(std::vector<ltm::MemoryId> links, read.ids("links"));
    return AnswerValue(answers::Reason{std::move(words), std::move(links)});
  }
  return invalid_argument("answer value: there is no kind '{}'", printable(kind));
}

}  // namespace engram::speech
