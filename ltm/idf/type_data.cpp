// SPDX-License-Identifier: Apache-2.0
#include <unordered_map>

#include "ltm/idf/binary.h"
#include "ltm/idf/type.h"

namespace engram::idf {

namespace {

constexpr int32_t kVersion = 1;
/// The bound of nodes in all entries of a table together: with sharing, a small table could
/// otherwise describe a huge type.
constexpr size_t kMaxTableNodes = size_t{1} << 22;

constexpr std::string_view kVersionKey = "idf_type";
constexpr std::string_view kTableKey = "types";

class TableWriter {
 public:
  /// The index of the entry of `type`, which is written if it is new.
  int32_t add(const Type& type) {
    if (const auto known = by_address_.find(&type.value()); known != by_address_.end())
      return known->second;
    Dict entry{{"kind", to_string(type.kind())}};
    if (type.is_optional()) entry.set("optional", true);
    if (!type.doc().empty()) entry.set("doc", type.doc());
    std::visit([&](const auto& value) { describe(value, entry); }, type.value());
    const int32_t index = add_entry(std::move(entry));
    by_address_.emplace(&type.value(), index);
    return index;
  }

  List take() { return std::move(table_); }

 private:
  int32_t add_entry(Dict entry) {
    const auto bytes = encode(entry);
    ENGRAM_CHECK(bytes.ok(), "{}", bytes.status().message());
    const auto [known, is_new] =
        by_bytes_.emplace(as_text(*bytes), static_cast<int32_t>(table_.size()));
    if (is_new) table_.emplace_back(std::move(entry));
    return known->second;
  }

  static void set_quantity(const Quantity& quantity, Dict& entry) {
    if (!quantity.unit.empty()) entry.set("unit", quantity.unit);
    if (quantity.minimum) entry.set("minimum", *quantity.minimum);
    if (quantity.maximum) entry.set("maximum", *quantity.maximum);
  }

  /// Writes the fields of the alternatives without parts.
  template <typename T>
  void describe(const T& value, Dict& entry) {
    if constexpr (requires { value.element; }) entry.set("element", to_string(value.element));
    if constexpr (requires { value.quantity; }) set_quantity(value.quantity, entry);
  }
  void describe(const types::IntEnum& value, Dict& entry) {
    List values;
    for (const EnumValue& named : value.values) {
      Dict made{{"name", named.name}, {"value", named.value}};
      if (!named.doc.empty()) made.set("doc", named.doc);
      values.emplace_back(std::move(made));
    }
    entry.set("name", value.name);
    entry.set("values", std::move(values));
  }
  void describe(const types::NdArray& value, Dict& entry) {
    entry.set("element", to_string(value.element));
    entry.set("shape", List(value.shape.begin(), value.shape.end()));
    set_quantity(value.quantity, entry);
  }
  void describe(const types::Matrix& value, Dict& entry) {
    entry.set("element", to_string(value.element));
    entry.set("rows", value.rows);
    entry.set("cols", value.cols);
    set_quantity(value.quantity, entry);
  }
  void describe(const types::Image& value, Dict& entry) {
    entry.set("pixel", to_string(value.pixel));
    entry.set("height", value.height);
    entry.set("width", value.width);
  }
  void describe(const types::PointCloud& value, Dict& entry) {
    entry.set("point", to_string(value.point));
    entry.set("count", value.count);
  }
  void describe(const types::List& value, Dict& entry) {
    entry.set("element", add(value.element));
    entry.set("size", value.size);
  }
  void describe(const types::Dict& value, Dict& entry) { entry.set("element", add(value.element)); }
  void describe(const types::Tuple& value, Dict& entry) {
    List elements;
    for (const Type& element : value.elements) elements.emplace_back(add(element));
    entry.set("elements", std::move(elements));
  }
  void describe(const types::Pair& value, Dict& entry) {
    entry.set("first", add(value.first));
    entry.set("second", add(value.second));
  }
  void describe(const types::Object& value, Dict& entry) {
    entry.set("name", value.name);
    if (value.base) entry.set("base", add(*value.base));
    List members;
    for (const Member& member : value.own_members) {
      Dict made{{"name", member.name}, {"type", add(member.type)}};
      if (!member.doc.empty()) made.set("doc", member.doc);
      members.emplace_back(std::move(made));
    }
    entry.set("members", std::move(members));
  }

  List table_;
  std::unordered_map<const TypeValue*, int32_t> by_address_;
  std::unordered_map<std::string, int32_t> by_bytes_;
};

/// Reads one entry; the first error is kept in `status`.
class EntryReader {
 public:
  EntryReader(const Dict& entry, const std::vector<Type>& known, Status& status)
      : entry_(entry), known_(known), status_(status) {}

  template <typename T>
  T get(std::string_view key) {
    const Data* value = entry_.find(key);
    if (value != nullptr && value->is<T>()) return value->get<T>();
    fail(key, value, Data(T{}).kind_name());
    return T{};
  }

  std::string text_or_empty(std::string_view key) {
    return entry_.find(key) == nullptr ? std::string() : get<std::string>(key);
  }

  bool flag(std::string_view key) { return entry_.find(key) != nullptr && get<bool>(key); }

  Quantity quantity() {
    Quantity read{.unit = text_or_empty("unit")};
    if (entry_.find("minimum") != nullptr) read.minimum = get<double>("minimum");
    if (entry_.find("maximum") != nullptr) read.maximum = get<double>("maximum");
    return read;
  }

  ElementType element() {
    const auto name = get<std::string>("element");
    return named(element_type_from_name(name), "element", name);
  }

  template <typename T>
  T named(std::optional<T> value, std::string_view key, std::string_view name) {
    if (value) return *value;
    if (status_.ok()) status_ = data_loss("'{}': '{}' is not known", key, name);
    return T{1};
  }

  Type type(std::string_view key) { return at(key, entry_.find(key)); }

  Type at(std::string_view key, const Data* index) {
    const auto* found = index == nullptr ? nullptr : index->get_if<int32_t>();
    if (found != nullptr && *found >= 0 && static_cast<size_t>(*found) < known_.size())
      return known_[static_cast<size_t>(*found)];
    fail(key, index, "the int32 index of an entry before");
    return Type::boolean();
  }

  /// The dicts of a list, as readers.
  std::vector<EntryReader> dicts(std::string_view key) {
    const Data* value = entry_.find(key);
    const List* list = value == nullptr ? nullptr : value->get_if<List>();
    std::vector<EntryReader> readers;
    if (list == nullptr) {
      fail(key, value, "list");
      return readers;
    }
    for (const Data& element : *list) {
      if (const Dict* dict = element.get_if<Dict>())
        readers.emplace_back(*dict, known_, status_);
      else
        fail(key, &element, "a list of dicts");
    }
    return readers;
  }

 private:
  void fail(std::string_view key, const Data* found, std::string_view needed) {
    if (status_.ok())
      status_ = data_loss("'{}': found {}, needs {}", key,
                          found == nullptr ? "nothing" : found->kind_name(), needed);
  }

  const Dict& entry_;
  const std::vector<Type>& known_;
  Status& status_;
};

Shape read_shape(EntryReader& reader) {
  Shape shape;
  for (const Data& size : reader.get<List>("shape"))
    shape.push_back(size.is<int64_t>() ? size.get<int64_t>() : INT64_MIN);
  return shape;
}

types::IntEnum read_enum(EntryReader& reader) {
  types::IntEnum read{reader.get<std::string>("name"), {}};
  for (EntryReader& value : reader.dicts("values"))
    read.values.push_back(
        {value.get<std::string>("name"), value.get<int32_t>("value"), value.text_or_empty("doc")});
  return read;
}

types::Object read_object(EntryReader& reader, bool has_base) {
  types::Object read{reader.get<std::string>("name"), {}, std::nullopt, {}};
  if (has_base) read.base = reader.type("base");
  for (EntryReader& member : reader.dicts("members"))
    read.own_members.push_back(
        {member.get<std::string>("name"), member.type("type"), member.text_or_empty("doc")});
  return read;
}

types::Tuple read_tuple(EntryReader& reader) {
  types::Tuple read;
  const auto indices = reader.get<List>("elements");
  for (const Data& index : indices) read.elements.push_back(reader.at("elements", &index));
  return read;
}

TypeValue read_value(TypeKind kind, EntryReader& reader, bool has_base) {
  switch (kind) {
    case TypeKind::kInt:
      return types::Int{reader.quantity()};
    case TypeKind::kLong:
      return types::Long{reader.quantity()};
    case TypeKind::kFloat:
      return types::Float{reader.quantity()};
    case TypeKind::kDouble:
      return types::Double{reader.quantity()};
    case TypeKind::kString:
      return types::String{};
    case TypeKind::kBool:
      return types::Bool{};
    case TypeKind::kTime:
      return types::Time{};
    case TypeKind::kMemoryLink:
      return types::MemoryLink{};
    case TypeKind::kIntEnum:
      return read_enum(reader);
    case TypeKind::kNdArray:
      return types::NdArray{reader.element(), read_shape(reader), reader.quantity()};
    case TypeKind::kMatrix:
      return types::Matrix{reader.get<int64_t>("rows"), reader.get<int64_t>("cols"),
                           reader.element(), reader.quantity()};
    case TypeKind::kQuaternion:
      return types::Quaternion{reader.element()};
    case TypeKind::kOrientation:
      return types::Orientation{reader.element()};
    case TypeKind::kPose:
      return types::Pose{reader.element()};
    case TypeKind::kImage: {
      const auto name = reader.get<std::string>("pixel");
      return types::Image{reader.named(pixel_type_from_name(name), "pixel", name),
                          reader.get<int64_t>("height"), reader.get<int64_t>("width")};
    }
    case TypeKind::kPointCloud: {
      const auto name = reader.get<std::string>("point");
      return types::PointCloud{reader.named(point_type_from_name(name), "point", name),
                               reader.get<int64_t>("count")};
    }
    case TypeKind::kList:
      return types::List{reader.type("element"), reader.get<int64_t>("size")};
    case TypeKind::kTuple:
      return read_tuple(reader);
    case TypeKind::kDict:
      return types::Dict{reader.type("element")};
    case TypeKind::kObject:
      return read_object(reader, has_base);
    case TypeKind::kPair:
      break;
  }
  return types::Pair{reader.type("first"), reader.type("second")};
}

std::optional<TypeKind> kind_from_name(std::string_view name) {
  for (size_t i = 0; i < std::variant_size_v<TypeValue>; ++i)
    if (to_string(static_cast<TypeKind>(i)) == name) return static_cast<TypeKind>(i);
  return std::nullopt;
}

Result<Type> read_entry(const Data& data, const std::vector<Type>& known) {
  const Dict* entry = data.get_if<Dict>();
  if (entry == nullptr) return data_loss("found {}, needs dict", data.kind_name());
  Status status;
  EntryReader reader(*entry, known, status);
  const auto name = reader.get<std::string>("kind");
  const auto kind = kind_from_name(name);
  if (status.ok() && !kind) return data_loss("'kind': '{}' is not known", name);
  ENGRAM_RETURN_IF_ERROR(status);
  TypeValue value = read_value(*kind, reader, entry->find("base") != nullptr);
  const bool is_optional = reader.flag("optional");
  std::string doc = reader.text_or_empty("doc");
  ENGRAM_RETURN_IF_ERROR(status);
  auto type = Type::create(std::move(value), is_optional, std::move(doc));
  if (!type.ok()) return data_loss("{}", type.status().message());
  return type;
}

}  // namespace

Data to_data(const Type& type) {
  TableWriter writer;
  // The type itself is the last entry, because every entry comes after those that it refers to.
  writer.add(type);
  return Dict{{kVersionKey.data(), kVersion}, {kTableKey.data(), writer.take()}};
}

Result<Type> type_from_data(const Data& data) {
  const Dict* dict = data.get_if<Dict>();
  const Data* version = dict == nullptr ? nullptr : dict->find(kVersionKey);
  const Data* table = dict == nullptr ? nullptr : dict->find(kTableKey);
  if (version == nullptr || table == nullptr || !table->is<List>())
    return data_loss("type: found {}, needs a dict with '{}' and a list '{}'", data.kind_name(),
                     kVersionKey, kTableKey);
  if (*version != Data(kVersion))
    return data_loss("type: its version is not {}, the only one known", kVersion);
  std::vector<Type> known;
  size_t nodes = 0;
  for (const Data& entry : table->get<List>()) {
    auto type = read_entry(entry, known);
    if (!type.ok()) return type.status().with_context(fmt::format("type: entry {}", known.size()));
    nodes += type->node_count();
    if (nodes > kMaxTableNodes)
      return data_loss("type: entry {}: the table needs more than {} nodes", known.size(),
                       kMaxTableNodes);
    known.push_back(std::move(type).value());
  }
  if (known.empty()) return data_loss("type: the table is empty, needs one entry at least");
  return known.back();
}

}  // namespace engram::idf
