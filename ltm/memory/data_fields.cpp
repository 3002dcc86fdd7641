// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/data_fields.h"

namespace engram::ltm {

Result<DataFields> DataFields::of(const idf::Data& data, std::string_view what) {
  if (const auto* dict = data.get_if<idf::Dict>()) return DataFields(*dict, what);
  return invalid_argument("{}: found {}, needs a dict", what, data.kind_name());
}

Status DataFields::unfitting(std::string_view key, std::string_view needed) const {
  const idf::Data* member = dict_->find(key);
  if (member == nullptr)
    return invalid_argument("{}: has no member '{}', needs {}", what_, key, needed);
  return invalid_argument("{}: member '{}' is {}, needs {}", what_, key, member->kind_name(),
                          needed);
}

Result<const idf::Data*> DataFields::data(std::string_view key) const {
  const idf::Data* member = dict_->find(key);
  if (member != nullptr) return member;
  return unfitting(key, "a value");
}

Result<const idf::List*> DataFields::list(std::string_view key) const {
  const idf::Data* member = dict_->find(key);
  const idf::List* list = member != nullptr ? member->get_if<idf::List>() : nullptr;
  if (list != nullptr) return list;
  return unfitting(key, "a list");
}

Result<std::string> DataFields::text(std::string_view key) const {
  const idf::Data* member = dict_->find(key);
  const auto* text = member != nullptr ? member->get_if<std::string>() : nullptr;
  if (text != nullptr) return *text;
  return unfitting(key, "a string");
}

Result<int64_t> DataFields::integer(std::string_view key) const {
  if (const idf::Data* member = dict_->find(key)) {
    if (const auto* value = member->get_if<int64_t>()) return *value;
    if (const auto* value = member->get_if<int32_t>()) return int64_t{*value};
  }
  return unfitting(key, "an integer");
}

Result<bool> DataFields::boolean(std::string_view key) const {
  const idf::Data* member = dict_->find(key);
  const bool* value = member != nullptr ? member->get_if<bool>() : nullptr;
  if (value != nullptr) return *value;
  return unfitting(key, "a bool");
}

Result<double> DataFields::number(std::string_view key) const {
  const idf::Data* member = dict_->find(key);
  if (member != nullptr && !member->is<bool>())
    if (const auto value = member->as_number()) return *value;
  return unfitting(key, "a number");
}

Result<Time> DataFields::time(std::string_view key) const {
  ENGRAM_ASSIGN_OR_RETURN(const int64_t ns, integer(key));
  return time_from_ns(ns);
}

Result<int32_t> DataFields::instance_index(std::string_view key) const {
  ENGRAM_ASSIGN_OR_RETURN(const int64_t index, integer(key));
  if (index < 0 || index > std::numeric_limits<int32_t>::max())
    return invalid_argument("{}: member '{}' is {}, which is no instance index", what_, key, index);
  return static_cast<int32_t>(index);
}

}  // namespace engram::ltm
