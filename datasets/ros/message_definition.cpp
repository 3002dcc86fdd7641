// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/message_definition.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <set>

#include "datasets/ros/definition_text.h"

namespace engram::datasets::ros {

namespace {

constexpr size_t kMaxTextBytes = 1 << 20;

struct NamedKind {
  std::string_view name;
  FieldKind kind;
};
constexpr std::array<NamedKind, 17> kKinds{{
    {"bool", FieldKind::kBool},
    {"int8", FieldKind::kInt8},
    {"uint8", FieldKind::kUInt8},
    {"byte", FieldKind::kUInt8},
    {"char", FieldKind::kUInt8},
    {"int16", FieldKind::kInt16},
    {"uint16", FieldKind::kUInt16},
    {"int32", FieldKind::kInt32},
    {"uint32", FieldKind::kUInt32},
    {"int64", FieldKind::kInt64},
    {"uint64", FieldKind::kUInt64},
    {"float32", FieldKind::kFloat32},
    {"float64", FieldKind::kFloat64},
    {"string", FieldKind::kString},
    {"time", FieldKind::kTime},
    {"duration", FieldKind::kDuration},
    {"wstring", FieldKind::kMessage},
}};

/// Types that nearly all definitions need and that some writers leave out.
constexpr std::array<std::array<std::string_view, 2>, 2> kBuiltin{{
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec"},
    {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec"},
}};

/// Removes the first line of `text` and returns it.
std::string_view take_line(std::string_view& text) {
  const size_t end = text.find('\n');
  const std::string_view line = trimmed(text.substr(0, end));
  text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  return line;
}

bool is_separator(std::string_view line) {
  return line.size() >= 8 && line.find_first_not_of('=') == std::string_view::npos;
}

std::string_view package_of(std::string_view type) {
  return type.substr(0, type.find('/'));
}

/// A field whose message type is still a name.
struct NamedField {
  Field field;
  std::string type;
};

/// Reads "[]", "[9]" or "[<=9]" after a type.
bool read_multiplicity(std::string_view brackets, Field& field) {
  std::string_view count = brackets.substr(1, brackets.size() - 2);
  field.multiplicity = Multiplicity::kSequence;
  if (count.empty()) return true;
  if (count.starts_with("<="))
    count.remove_prefix(2);
  else
    field.multiplicity = Multiplicity::kFixed;
  uint32_t number = 0;
  const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), number);
  if (field.multiplicity == Multiplicity::kFixed) field.count = number;
  return error == std::errc() && end == count.data() + count.size();
}

/// Reads "float64[9] k"; returns nothing for a constant.
Result<std::optional<NamedField>> read_field(std::string_view line) {
  const size_t type_end = line.find_first_of(kSpace);
  if (type_end == std::string_view::npos)
    return invalid_argument("'{}' is no field, needs a type and a name", line);
  std::string_view type = line.substr(0, type_end);
  const std::string_view rest = trimmed(line.substr(type_end));
  const size_t name_end = rest.find_first_of(" \t=");
  NamedField named;
  named.field.name = rest.substr(0, name_end);
  if (named.field.name.empty()) return invalid_argument("'{}' has no name", line);
  if (name_end != std::string_view::npos && trimmed(rest.substr(name_end)).starts_with('='))
    return std::optional<NamedField>();
  if (const size_t bracket = type.find('['); bracket != std::string_view::npos) {
    if (!type.ends_with(']') || !read_multiplicity(type.substr(bracket), named.field))
      return invalid_argument("'{}' is no array, needs [], [N] or [<=N]", line);
    type = type.substr(0, bracket);
  }
  type = type.substr(0, type.find("<="));
  const auto* kind = std::ranges::find(kKinds, type, &NamedKind::name);
  named.field.kind = kind == kKinds.end() ? FieldKind::kMessage : kind->kind;
  named.type = plain_type_name(type == "Header" ? "std_msgs/Header" : type);
  if (type == "wstring")
    return invalid_argument("'{}' has wide characters, which are not read", line);
  return std::optional(std::move(named));
}

}  // namespace

size_t size_bytes(FieldKind kind) {
  switch (kind) {
    case FieldKind::kBool:
    case FieldKind::kInt8:
    case FieldKind::kUInt8:
      return 1;
    case FieldKind::kInt16:
    case FieldKind::kUInt16:
      return 2;
    case FieldKind::kInt32:
    case FieldKind::kUInt32:
    case FieldKind::kFloat32:
      return 4;
    case FieldKind::kInt64:
    case FieldKind::kUInt64:
    case FieldKind::kFloat64:
      return 8;
    default:
      return 0;
  }
}

std::string plain_type_name(std::string_view type) {
  const size_t middle = type.find("/msg/");
  if (middle == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, middle)) + std::string(type.substr(middle + 4));
}

/// Reads all sections first, because a section may use later ones; then follows the names from the
/// root.
class DefinitionParser {
 public:
  Result<MessageDefinition> parse(std::string_view type, std::string_view text) {
    if (text.size() > kMaxTextBytes)
      return invalid_argument("definition has {} bytes, needs at most {}", text.size(),
                              kMaxTextBytes);
    const std::string root = plain_type_name(type);
    ENGRAM_RETURN_IF_ERROR(read_sections(root, text));
    for (const auto& [name, builtin] : kBuiltin)
      if (!sections_.contains(std::string(name)))
        ENGRAM_RETURN_IF_ERROR(read_sections(std::string(name), builtin));
    ENGRAM_RETURN_IF_ERROR(add(root, 0).status());
    return std::move(definition_);
  }

 private:
  Status read_sections(std::string name, std::string_view text) {
    std::vector<NamedField>* fields = &sections_[name];
    while (!text.empty()) {
      std::string_view line = take_line(text);
      if (is_separator(line)) {
        line = take_line(text);
        if (!line.starts_with("MSG:"))
          return invalid_argument("after '{}': '{}', needs 'MSG: package/Type'", name, line);
        name = plain_type_name(trimmed(line.substr(4)));
        fields = &sections_[name];
        fields->clear();
        continue;
      }
      line = trimmed(line.substr(0, line.find('#')));
      if (line.empty()) continue;
      auto field = read_field(line);
      if (!field.ok()) return field.status().with_context(name);
      if (*field) fields->push_back(**std::move(field));
    }
    return {};
  }

  /// Finds the section that `type` refers to inside of a message.
  Result<std::string> resolve(const std::string& type, const std::string& inside) const {
    if (sections_.contains(type)) return type;
    if (type.find('/') == std::string::npos) {
      const std::string sibling = std::string(package_of(inside)) + "/" + type;
      if (sections_.contains(sibling)) return sibling;
      for (const auto& [name, fields] : sections_)
        if (name.ends_with("/" + type)) return name;
    }
    return invalid_argument("{}: '{}' is defined nowhere", inside, type);
  }

  Result<size_t> add(const std::string& name, int depth) {
    if (depth >= kMaxDepth)
      return invalid_argument("{}: messages nest {} deep, or in themselves", name, depth);
    if (const auto known = indices_.find(name); known != indices_.end()) {
      // A message that is not complete yet contains itself.
      if (!whole_.contains(name)) return invalid_argument("{}: contains itself", name);
      return known->second;
    }
    const size_t index = definition_.messages_.size();
    indices_[name] = index;
    definition_.messages_.push_back({name, {}});
    std::vector<Field> fields;
    std::set<std::string> names;
    for (const NamedField& named : sections_.at(name)) {
      Field field = named.field;
      if (!names.insert(field.name).second)
        return invalid_argument("{}: has two fields '{}'", name, field.name);
      if (field.kind == FieldKind::kMessage) {
        ENGRAM_ASSIGN_OR_RETURN(const std::string type, resolve(named.type, name));
        ENGRAM_ASSIGN_OR_RETURN(field.message, add(type, depth + 1));
      }
      fields.push_back(std::move(field));
    }
    definition_.messages_[index].fields = std::move(fields);
    whole_.insert(name);
    return index;
  }

  std::map<std::string, std::vector<NamedField>, std::less<>> sections_;
  std::map<std::string, size_t> indices_;
  std::set<std::string> whole_;
  MessageDefinition definition_;
};

Result<MessageDefinition> MessageDefinition::parse(std::string_view type, std::string_view text) {
  auto definition = DefinitionParser().parse(type, text);
  if (!definition.ok())
    return definition.status().with_context(fmt::format("definition of '{}'", type));
  return definition;
}

}  // namespace engram::datasets::ros
