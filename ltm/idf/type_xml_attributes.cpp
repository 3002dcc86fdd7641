// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "ltm/core/ascii.h"
#include "ltm/idf/type_xml_element.h"

namespace engram::idf {

namespace {

/// Attributes for code generators of other systems; they do not describe the data.
constexpr std::array<std::string_view, 6> kCodeAttributes{
    "shared_ptr", "unique_ptr", "raw_ptr", "autoinclude", "humanreadablename", "template"};

/// Reads a number that takes the whole text.
template <typename T>
std::optional<T> parse(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<ElementType> element_type_from_alias(const std::string& name) {
  static constexpr std::array<std::pair<std::string_view, ElementType>, 9> kAliases{
      {{"float", ElementType::kFloat32},
       {"double", ElementType::kFloat64},
       {"int", ElementType::kInt32},
       {"long", ElementType::kInt64},
       {"short", ElementType::kInt16},
       {"char", ElementType::kInt8},
       {"byte", ElementType::kUInt8},
       {"uchar", ElementType::kUInt8},
       {"unsigned char", ElementType::kUInt8}}};
  for (const auto& [alias, type] : kAliases)
    if (alias == name) return type;
  return element_type_from_name(name);
}

}  // namespace

XmlText::XmlText(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {
  for (size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1))
    line_ends_.push_back(at);
}

std::string XmlText::place(ptrdiff_t offset) const {
  const auto at = static_cast<size_t>(std::max<ptrdiff_t>(offset, 0));
  const auto ends_before = std::ranges::lower_bound(line_ends_, at) - line_ends_.begin();
  return fmt::format("{}:{}", name_, ends_before + 1);
}

Status XmlText::error(const pugi::xml_node& node, std::string_view message) const {
  return invalid_argument("{}: {}", place(node), message);
}

Result<XmlAttributes> XmlAttributes::read(const XmlText& source, const pugi::xml_node& node,
                                          std::initializer_list<std::string_view> allowed,
                                          std::vector<std::string>& notes) {
  XmlAttributes made(source, node);
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    std::string name = lower_ascii(attribute.name());
    if (std::ranges::count(kCodeAttributes, name) != 0) {
      notes.push_back(fmt::format("{}: attribute '{}' of <{}> is for code alone",
                                  source.place(node), attribute.name(), node.name()));
      continue;
    }
    // Unknown attributes are errors: a misspelt bound would otherwise be ignored in silence.
    if (std::ranges::find(allowed, name) == allowed.end()) {
      std::string known;
      for (const std::string_view each : allowed)
        known += (known.empty() ? "" : ", ") + std::string(each);
      return source.error(node, fmt::format("<{}> has the attribute '{}', needs one of: {}",
                                            node.name(), attribute.name(), known));
    }
    made.values_.emplace_back(std::move(name), attribute.value());
  }
  return made;
}

std::optional<std::string_view> XmlAttributes::find(std::string_view name) const {
  for (const auto& [key, value] : values_)
    if (key == name) return value;
  return std::nullopt;
}

Result<std::string_view> XmlAttributes::get(std::string_view name) const {
  if (const auto value = find(name)) return *value;
  return source_->error(node_,
                        fmt::format("<{}> has no attribute '{}', needs it", node_.name(), name));
}

Result<int64_t> XmlAttributes::size(std::string_view name) const {
  const auto text = find(name);
  if (!text || *text == "-1" || *text == "*" || lower_ascii(*text) == "dynamic") return kFreeSize;
  const auto value = parse<int64_t>(*text);
  if (value && *value >= 0) return *value;
  return source_->error(
      node_,
      fmt::format("{}=\"{}\": needs a size of zero or more, or -1 for a free one", name, *text));
}

Result<bool> XmlAttributes::flag(std::string_view name) const {
  const auto text = find(name);
  if (!text || *text == "false" || *text == "0") return false;
  if (*text == "true" || *text == "1") return true;
  return source_->error(node_, fmt::format("{}=\"{}\": needs true or false", name, *text));
}

Result<ElementType> XmlAttributes::element_type() const {
  const auto text = find("type");
  if (!text) return ElementType::kFloat32;
  if (const auto type = element_type_from_alias(lower_ascii(*text))) return *type;
  return source_->error(node_, fmt::format("type=\"{}\": needs int8, int16, int32, int64, uint8, "
                                           "uint16, uint32, uint64, float32 or float64",
                                           *text));
}

Result<std::optional<double>> XmlAttributes::bound(std::string_view name,
                                                   std::string_view long_name) const {
  const auto text = find(name) ? find(name) : find(long_name);
  if (!text) return std::optional<double>();
  const auto value = parse<double>(*text);
  if (value && std::isfinite(*value)) return value;
  return source_->error(node_, fmt::format("{}=\"{}\": needs a number", name, *text));
}

Result<Quantity> XmlAttributes::quantity() const {
  Quantity made{.unit = std::string(find("unit").value_or(""))};
  ENGRAM_ASSIGN_OR_RETURN(made.minimum, bound("min", "minimum"));
  ENGRAM_ASSIGN_OR_RETURN(made.maximum, bound("max", "maximum"));
  return made;
}

}  // namespace engram::idf
