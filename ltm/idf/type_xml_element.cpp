// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type_xml_element.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "ltm/core/ascii.h"

namespace engram::idf {

namespace {

struct ElementName {
  std::string_view name;
  TypeKind kind;
};

constexpr std::array<ElementName, 25> kElementNames{{{"int", TypeKind::kInt},
                                                     {"int32", TypeKind::kInt},
                                                     {"long", TypeKind::kLong},
                                                     {"int64", TypeKind::kLong},
                                                     {"float", TypeKind::kFloat},
                                                     {"float32", TypeKind::kFloat},
                                                     {"double", TypeKind::kDouble},
                                                     {"float64", TypeKind::kDouble},
                                                     {"string", TypeKind::kString},
                                                     {"bool", TypeKind::kBool},
                                                     {"time", TypeKind::kTime},
                                                     {"memorylink", TypeKind::kMemoryLink},
                                                     {"intenum", TypeKind::kIntEnum},
                                                     {"ndarray", TypeKind::kNdArray},
                                                     {"matrix", TypeKind::kMatrix},
                                                     {"quaternion", TypeKind::kQuaternion},
                                                     {"orientation", TypeKind::kOrientation},
                                                     {"pose", TypeKind::kPose},
                                                     {"image", TypeKind::kImage},
                                                     {"pointcloud", TypeKind::kPointCloud},
                                                     {"list", TypeKind::kList},
                                                     {"tuple", TypeKind::kTuple},
                                                     {"dict", TypeKind::kDict},
                                                     {"object", TypeKind::kObject},
                                                     {"pair", TypeKind::kPair}}};

/// An array of three metres; it has no kind of its own.
constexpr std::string_view kPositionElement = "position";

bool is_same_word(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return lower_ascii(c); };
  return std::ranges::equal(a, b, {}, lower, lower);
}

std::optional<TypeKind> kind_of_element(std::string_view name) {
  for (const ElementName& element : kElementNames)
    if (is_same_word(element.name, name)) return element.kind;
  return std::nullopt;
}

bool is_identifier(std::string_view name) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  return !name.empty() && is_letter(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::string name_of(const pugi::xml_node& node) {
  switch (node.type()) {
    case pugi::node_element:
      return fmt::format("<{}>", node.name());
    case pugi::node_pcdata:
    case pugi::node_cdata:
      return fmt::format("the text '{}'", std::string(trim(node.value())).substr(0, 40));
    default:
      return "something else";
  }
}

/// The children that count: all but comments, declarations and processing instructions.
std::vector<pugi::xml_node> children_of(const pugi::xml_node& node) {
  std::vector<pugi::xml_node> children;
  for (const pugi::xml_node& child : node.children())
    if (child.type() != pugi::node_comment && child.type() != pugi::node_pi &&
        child.type() != pugi::node_doctype && child.type() != pugi::node_declaration)
      children.push_back(child);
  return children;
}

/// "a::b" for "a::b::C".
std::string_view namespace_of(std::string_view name) {
  const size_t at = name.rfind("::");
  return at == std::string_view::npos ? std::string_view() : name.substr(0, at);
}

}  // namespace

bool is_type_element(std::string_view name) {
  return kind_of_element(name).has_value() || is_same_word(name, kPositionElement);
}

bool is_type_name(std::string_view name) {
  for (size_t at = name.find("::"); at != std::string_view::npos; at = name.find("::")) {
    if (!is_identifier(name.substr(0, at))) return false;
    name.remove_prefix(at + 2);
  }
  return is_identifier(name);
}

std::string read_doc(const pugi::xml_node& node) {
  if (const pugi::xml_attribute doc = node.attribute("doc")) return std::string(trim(doc.value()));
  std::vector<std::string_view> comments;
  for (auto before = node.previous_sibling(); before.type() == pugi::node_comment;
       before = before.previous_sibling())
    comments.push_back(trim(before.value()));
  std::string text;
  for (auto comment = comments.rbegin(); comment != comments.rend(); ++comment)
    text += (text.empty() ? "" : "\n") + std::string(*comment);
  return text;
}

Result<Type> XmlTypeReader::read_definition(const pugi::xml_node& node) {
  return is_same_word(node.name(), "IntEnum") ? read_enum(node) : read_object(node);
}

Result<Type> XmlTypeReader::read_object(const pugi::xml_node& node) {
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          XmlAttributes::read(source_, node, {"name", "extends", "doc"}, notes_));
  types::Object object;
  ENGRAM_ASSIGN_OR_RETURN(object.name, attributes.get("name"));
  const std::string_view scope = namespace_of(object.name);
  if (const auto base = attributes.find("extends")) {
    ENGRAM_ASSIGN_OR_RETURN(object.base, find_type_(*base, scope));
    if (!object.base)
      return source_.error(
          node, fmt::format("extends=\"{}\": needs the name of an Object in this file or an "
                            "included one",
                            *base));
  }
  for (const pugi::xml_node& child : children_of(node)) {
    if (!is_same_word(child.name(), "ObjectChild"))
      return source_.error(
          child, fmt::format("found {} in <Object>, needs <ObjectChild key=...>", name_of(child)));
    ENGRAM_ASSIGN_OR_RETURN(Member member, read_member(child, scope));
    object.own_members.push_back(std::move(member));
  }
  // Type::create knows no lines, so its errors get the place of the element.
  auto type = Type::create(std::move(object), false, read_doc(node));
  return type.ok() ? type : source_.error(node, type.status().message());
}

Result<Member> XmlTypeReader::read_member(const pugi::xml_node& node, std::string_view scope) {
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          XmlAttributes::read(source_, node, {"key", "optional", "doc"}, notes_));
  ENGRAM_ASSIGN_OR_RETURN(const std::string_view key, attributes.get("key"));
  if (!is_identifier(key))
    return source_.error(node, fmt::format("key=\"{}\": needs a letter or '_', then letters, "
                                           "digits and '_'",
                                           key));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_optional, attributes.flag("optional"));
  ENGRAM_ASSIGN_OR_RETURN(std::vector<Type> parts, read_parts(node, 1, 1, scope, 1));
  Type type = is_optional ? parts.front().optional() : parts.front();
  return Member{std::string(key), std::move(type), read_doc(node)};
}

Result<Type> XmlTypeReader::read_enum(const pugi::xml_node& node) {
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          XmlAttributes::read(source_, node, {"name", "doc"}, notes_));
  types::IntEnum named;
  ENGRAM_ASSIGN_OR_RETURN(named.name, attributes.get("name"));
  for (const pugi::xml_node& child : children_of(node)) {
    if (!is_same_word(child.name(), "EnumValue"))
      return source_.error(child, fmt::format("found {} in <IntEnum>, needs <EnumValue key=... "
                                              "value=...>",
                                              name_of(child)));
    ENGRAM_ASSIGN_OR_RETURN(const auto entry,
                            XmlAttributes::read(source_, child, {"key", "value", "doc"}, notes_));
    ENGRAM_ASSIGN_OR_RETURN(const std::string_view key, entry.get("key"));
    ENGRAM_ASSIGN_OR_RETURN(const std::string_view text, entry.get("value"));
    ENGRAM_RETURN_IF_ERROR(check_empty(child));
    int32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      return source_.error(child, fmt::format("value=\"{}\": needs an int32", text));
    if (!is_identifier(key))
      return source_.error(child, fmt::format("key=\"{}\": needs a letter or '_', then letters, "
                                              "digits and '_'",
                                              key));
    named.values.push_back({std::string(key), value, read_doc(child)});
  }
  auto type = Type::create(std::move(named), false, read_doc(node));
  return type.ok() ? type : source_.error(node, type.status().message());
}

Result<Type> XmlTypeReader::read_type(const pugi::xml_node& node, std::string_view scope,
                                      int depth) {
  // Checked before the types inside are read: hostile text could exhaust the stack.
  if (depth > kMaxTypeDepth)
    return source_.error(node, fmt::format("nests deeper than {} types", kMaxTypeDepth));
  if (node.type() != pugi::node_element)
    return source_.error(node, fmt::format("found {}, needs the element of a type", name_of(node)));
  if (is_same_word(node.name(), kPositionElement)) return finish(node, read_position(node));
  const auto kind = kind_of_element(node.name());
  if (!kind) return read_reference(node, scope);
  switch (*kind) {
    case TypeKind::kObject:
    case TypeKind::kIntEnum:
      return source_.error(node, fmt::format("<{}> stands inside another type, needs to stand in "
                                             "<GenerateTypes> and to be used by its name",
                                             node.name()));
    case TypeKind::kList:
    case TypeKind::kTuple:
    case TypeKind::kDict:
    case TypeKind::kPair:
      return finish(node, read_container(node, *kind, scope, depth));
    case TypeKind::kInt:
    case TypeKind::kLong:
    case TypeKind::kFloat:
    case TypeKind::kDouble:
    case TypeKind::kString:
    case TypeKind::kBool:
    case TypeKind::kTime:
    case TypeKind::kMemoryLink:
      return finish(node, read_scalar(node, *kind));
    default:
      ENGRAM_RETURN_IF_ERROR(check_empty(node));
      return finish(node, read_array(node, *kind));
  }
}

Result<TypeValue> XmlTypeReader::read_scalar(const pugi::xml_node& node, TypeKind kind) {
  ENGRAM_RETURN_IF_ERROR(check_empty(node));
  const bool is_number = kind == TypeKind::kInt || kind == TypeKind::kLong ||
                         kind == TypeKind::kFloat || kind == TypeKind::kDouble;
  ENGRAM_ASSIGN_OR_RETURN(
      const auto attributes,
      is_number ? XmlAttributes::read(
                      source_, node,
                      {"optional", "doc", "unit", "min", "max", "minimum", "maximum"}, notes_)
                : XmlAttributes::read(source_, node, {"optional", "doc"}, notes_));
  ENGRAM_ASSIGN_OR_RETURN(Quantity quantity, attributes.quantity());
  switch (kind) {
    case TypeKind::kInt:
      return TypeValue(types::Int{std::move(quantity)});
    case TypeKind::kLong:
      return TypeValue(types::Long{std::move(quantity)});
    case TypeKind::kFloat:
      return TypeValue(types::Float{std::move(quantity)});
    case TypeKind::kDouble:
      return TypeValue(types::Double{std::move(quantity)});
    case TypeKind::kString:
      return TypeValue(types::String{});
    case TypeKind::kBool:
      return TypeValue(types::Bool{});
    case TypeKind::kTime:
      return TypeValue(types::Time{});
    default:
      return TypeValue(types::MemoryLink{});
  }
}

Result<TypeValue> XmlTypeReader::read_container(const pugi::xml_node& node, TypeKind kind,
                                                std::string_view scope, int depth) {
  const auto read = [&](std::initializer_list<std::string_view> allowed) {
    return XmlAttributes::read(source_, node, allowed, notes_);
  };
  if (kind == TypeKind::kList) {
    ENGRAM_ASSIGN_OR_RETURN(const auto attributes, read({"optional", "doc", "size"}));
    ENGRAM_ASSIGN_OR_RETURN(const int64_t size, attributes.size("size"));
    ENGRAM_ASSIGN_OR_RETURN(const auto parts, read_parts(node, 1, 1, scope, depth));
    return TypeValue(types::List{parts[0], size});
  }
  ENGRAM_RETURN_IF_ERROR(read({"optional", "doc"}).status());
  if (kind == TypeKind::kTuple) {
    ENGRAM_ASSIGN_OR_RETURN(auto parts, read_parts(node, 1, SIZE_MAX, scope, depth));
    return TypeValue(types::Tuple{std::move(parts)});
  }
  const size_t count = kind == TypeKind::kDict ? 1 : 2;
  ENGRAM_ASSIGN_OR_RETURN(const auto parts, read_parts(node, count, count, scope, depth));
  if (kind == TypeKind::kDict) return TypeValue(types::Dict{parts[0]});
  return TypeValue(types::Pair{parts[0], parts[1]});
}

Result<Type> XmlTypeReader::read_reference(const pugi::xml_node& node, std::string_view scope) {
  ENGRAM_RETURN_IF_ERROR(check_empty(node));
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          XmlAttributes::read(source_, node, {"optional", "doc"}, notes_));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_optional, attributes.flag("optional"));
  auto found = find_type_(node.name(), scope);
  if (!found.ok()) return found.status().with_context(source_.place(node));
  if (!*found)
    return source_.error(node, fmt::format("<{}> is not known: needs the element of a type, or the "
                                           "name of one in this file or an included one",
                                           node.name()));
  return (*found)->with_optional(is_optional);
}

Result<Type> XmlTypeReader::finish(const pugi::xml_node& node, Result<TypeValue> value) {
  ENGRAM_RETURN_IF_ERROR(value.status());
  bool is_optional = false;
  std::string doc;
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    const std::string_view name = attribute.name();
    const std::string_view text = attribute.value();
    if (is_same_word(name, "doc")) doc = trim(text);
    if (!is_same_word(name, "optional")) continue;
    if (text != "true" && text != "1" && text != "false" && text != "0")
      return source_.error(node, fmt::format("optional=\"{}\": needs true or false", text));
    is_optional = text == "true" || text == "1";
  }
  auto type = Type::create(std::move(value).value(), is_optional, std::move(doc));
  return type.ok() ? type : source_.error(node, type.status().message());
}

Result<std::vector<Type>> XmlTypeReader::read_parts(const pugi::xml_node& node, size_t min,
                                                    size_t max, std::string_view scope, int depth) {
  const std::vector<pugi::xml_node> children = children_of(node);
  if (children.size() < min || children.size() > max)
    return source_.error(
        node, fmt::format("<{}> has {} elements, needs {} ", node.name(), children.size(), min) +
                  (min == max ? "exactly" : "at least"));
  std::vector<Type> parts;
  for (const pugi::xml_node& child : children) {
    ENGRAM_ASSIGN_OR_RETURN(Type type, read_type(child, scope, depth + 1));
    parts.push_back(std::move(type));
  }
  return parts;
}

Status XmlTypeReader::check_empty(const pugi::xml_node& node) const {
  const std::vector<pugi::xml_node> children = children_of(node);
  if (children.empty()) return {};
  return source_.error(children.front(), fmt::format("found {} in <{}>, which needs to be empty",
                                                     name_of(children.front()), node.name()));
}

}  // namespace engram::idf
