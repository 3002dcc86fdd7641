// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/attributes.h"

#include <algorithm>

#include "datasets/hdf5/row_value.h"
#include "ltm/core/utf8.h"

namespace engram::datasets {

namespace {

/// Describes an attribute as an array of one row.
h5::ArrayInfo as_row(const h5::Attribute& attribute) {
  h5::ArrayInfo info{attribute.element, {1}};
  info.shape.insert(info.shape.end(), attribute.shape.begin(), attribute.shape.end());
  return info;
}

std::optional<idf::Data> to_value(const h5::Attribute& attribute) {
  if (attribute.element.is_number()) {
    const bool is_bool = attribute.element.kind == h5::Kind::kBool;
    if (is_bool && attribute.shape.size() == 1) {
      idf::List flags;
      for (const std::byte flag : attribute.bytes) flags.emplace_back(flag != std::byte{0});
      return flags;
    }
    const idf::Data row = row_value(as_row(attribute), RowRole::kValues, attribute.bytes);
    return row.get<idf::Dict>().begin()->value;
  }
  if (!std::ranges::all_of(attribute.texts, is_utf8) || attribute.shape.size() > 1)
    return std::nullopt;
  if (attribute.shape.empty())
    return attribute.texts.empty() ? std::string() : attribute.texts.front();
  return idf::List(attribute.texts.begin(), attribute.texts.end());
}

/// Makes an attribute from a list of texts or of bools.
std::optional<h5::Attribute> list_attribute(const idf::List& list) {
  h5::Attribute attribute{{h5::Kind::kText}, {list.size()}, {}, {}};
  const bool are_bools = !list.empty() && list.front().is<bool>();
  if (are_bools) attribute.element = {h5::Kind::kBool};
  for (const idf::Data& one : list) {
    if (const auto* flag = one.get_if<bool>(); flag != nullptr && are_bools)
      attribute.bytes.push_back(std::byte{*flag});
    else if (const auto* text = one.get_if<std::string>(); text != nullptr && !are_bools)
      attribute.texts.push_back(*text);
    else
      return std::nullopt;
  }
  return attribute;
}

std::optional<h5::Attribute> to_attribute(const idf::Data& value) {
  if (const auto* list = value.get_if<idf::List>()) return list_attribute(*list);
  const auto form = row_form(value);
  if (!form) return std::nullopt;
  if (const auto* text = value.get_if<std::string>())
    return h5::Attribute{{h5::Kind::kText}, {}, {}, {*text}};
  return h5::Attribute{form->element, form->shape, row_bytes(value), {}};
}

}  // namespace

idf::Dict read_attributes(const h5::File& file, const std::string& object, ReadingReport& report) {
  idf::Dict values;
  const auto names = file.attribute_names(object);
  if (!names.ok()) ++report.not_carried["attributes that cannot be listed"];
  for (const std::string& name : names.value_or({})) {
    const auto attribute = file.attribute(object, name);
    const auto value = attribute.ok() ? to_value(*attribute) : std::nullopt;
    if (value && is_utf8(name))
      values.set(name, *value);
    else
      ++report.not_carried["attributes that cannot be read"];
  }
  return values;
}

Status write_attributes(h5::File& file, const std::string& object, const idf::Dict& attributes) {
  for (const auto& [name, value] : attributes)
    if (const auto attribute = to_attribute(value))
      ENGRAM_RETURN_IF_ERROR(file.write_attribute(object, name, *attribute));
  return {};
}

}  // namespace engram::datasets
