// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/series_reader.h"

#include <algorithm>
#include <bit>
#include <string_view>
#include <utility>

namespace engram::ltm {

namespace {

/// Max number of dead links whose texts are kept, for each member.
constexpr size_t kMaxDeadTexts = 256;
/// Max number of members: a dict may have any keys.
constexpr size_t kMaxSeriesMembers = 4096;

uint64_t hash_of_bytes(std::span<const std::byte> bytes) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// Bools, enums and counts do not move: whole numbers without a unit are counts.
NumberColumn::Meaning meaning_of(const std::optional<idf::Type>& type, bool is_bool) {
  const auto is_kind = [&type](idf::TypeKind kind) { return type && type->kind() == kind; };
  const bool is_whole = is_kind(idf::TypeKind::kInt) || is_kind(idf::TypeKind::kLong);
  if (is_bool || is_kind(idf::TypeKind::kIntEnum) || (is_whole && type->quantity()->unit.empty()))
    return NumberColumn::Meaning::kDiscrete;
  return NumberColumn::Meaning::kQuantity;
}

template <typename T>
void append_elements(const idf::NdArray& array, std::vector<double>& values) {
  for (const T value : array.values<T>()) values.push_back(static_cast<double>(value));
}

void append_all(const idf::NdArray& array, std::vector<double>& values) {
  switch (array.type()) {
    case idf::ElementType::kInt8:
      return append_elements<int8_t>(array, values);
    case idf::ElementType::kInt16:
      return append_elements<int16_t>(array, values);
    case idf::ElementType::kInt32:
      return append_elements<int32_t>(array, values);
    case idf::ElementType::kInt64:
      return append_elements<int64_t>(array, values);
    case idf::ElementType::kUInt8:
      return append_elements<uint8_t>(array, values);
    case idf::ElementType::kUInt16:
      return append_elements<uint16_t>(array, values);
    case idf::ElementType::kUInt32:
      return append_elements<uint32_t>(array, values);
    case idf::ElementType::kUInt64:
      return append_elements<uint64_t>(array, values);
    case idf::ElementType::kFloat32:
      return append_elements<float>(array, values);
    case idf::ElementType::kFloat64:
      return append_elements<double>(array, values);
  }
}

/// Rows are read one after the other, elements are looked at one after the other.
void order_by_element(NumberColumn& column) {
  if (column.width == 1) return;
  const size_t rows = column.rows.size();
  std::vector<double> ordered(column.values.size());
  // By tiles that stay in the cache.
  constexpr size_t kTile = 64;
  for (size_t first = 0; first < rows; first += kTile)
    for (size_t k = 0; k < column.width; ++k)
      for (size_t i = first; i < std::min(rows, first + kTile); ++i)
        ordered[k * rows + i] = column.values[i * column.width + k];
  column.values = std::move(ordered);
}

}  // namespace

/// A place in the values, with the columns that it fills.
struct SeriesReader::Node {
  std::string key;
  std::string path;
  std::optional<idf::Type> type;
  std::vector<std::unique_ptr<Node>> children;
  std::optional<size_t> numbers;
  std::optional<size_t> links;
  bool is_left_out = false;

  /// The child of a key. Values of one layout find it at the same position as before.
  Node& child(size_t position, const std::string& name) {
    if (position < children.size() && children[position]->key == name) return *children[position];
    for (const auto& known : children)
      if (known->key == name) return *known;
    auto added = std::make_unique<Node>();
    added->key = name;
    added->path = idf::join_path(path, name);
    added->type = type_of(name);
    added->is_left_out = is_left_out;
    children.push_back(std::move(added));
    return *children.back();
  }

  /// The type of a part: of a member by its name, of elements the one that they share.
  [[nodiscard]] std::optional<idf::Type> type_of(const std::string& name) const {
    if (!type) return std::nullopt;
    for (const idf::Member& part : type->parts())
      if (part.name == name || part.name.empty()) return part.type;
    return std::nullopt;
  }
};

SeriesReader::SeriesReader(SeriesBlock empty, std::optional<idf::Type> type, LinkTargets& targets)
    : block_(std::move(empty)), root_(std::make_unique<Node>()), targets_(&targets) {
  root_->type = std::move(type);
}
SeriesReader::~SeriesReader() = default;
SeriesReader::SeriesReader(SeriesReader&&) noexcept = default;

void SeriesReader::mix(uint64_t hash, bool is_value) {
  const auto mixed = [hash](uint64_t before) {
    return (std::rotl(before, 23) ^ hash) * 0x9e3779b97f4a7c15ULL;
  };
  full_hash_ = mixed(full_hash_);
  if (is_value) value_hash_ = mixed(value_hash_);
}

Status SeriesReader::add(Time time, Time arrived, const idf::Data& value) {
  block_.times.push_back(to_ns(time));
  // A program that says nothing of the arrival leaves it at zero.
  block_.latencies.push_back(arrived == Time{} ? 0 : to_ns(arrived) - to_ns(time));
  value_hash_ = full_hash_ = 1;
  const Status walked = walk(value, *root_);
  block_.value_hashes.push_back(value_hash_);
  block_.full_hashes.push_back(full_hash_);
  held_ += 4;
  return walked;
}

void SeriesReader::add_image(const std::string& path, uint64_t hash) {
  ImageColumn* column = nullptr;
  for (ImageColumn& known : block_.images)
    if (known.path == path) column = &known;
  if (column == nullptr) column = &block_.images.emplace_back(ImageColumn{path, {}, {}});
  column->rows.push_back(static_cast<uint32_t>(block_.rows() - 1));
  column->hashes.push_back(hash);
}

Status SeriesReader::walk(const idf::Data& value, Node& node) {
  const auto meaning = meaning_of(node.type, value.is<bool>());
  if (const auto* dict = value.get_if<idf::Dict>()) return walk_dict(*dict, node);
  if (const auto* list = value.get_if<idf::List>()) return walk_list(*list, node);
  if (const auto* array = value.get_if<idf::NdArray>()) {
    add_array(*array, node);
    return {};
  }
  if (const auto* text = value.get_if<std::string>()) return add_text(*text, node);
  if (const auto* whole = value.get_if<int64_t>();
      whole != nullptr && node.type && node.type->kind() == idf::TypeKind::kTime) {
    block_.has_identity = true;
    mix(static_cast<uint64_t>(*whole), false);
    return {};
  }
  if (const auto number = value.as_number()) {
    add_number(*number, node, meaning);
    mix(std::bit_cast<uint64_t>(*number), true);
  } else {
    mix(0, true);
  }
  return {};
}

Status SeriesReader::walk_dict(const idf::Dict& dict, Node& node) {
  size_t position = 0;
  for (const idf::DictEntry& entry : dict) {
    if (node.children.size() >= kMaxSeriesMembers) return {};
    ENGRAM_RETURN_IF_ERROR(walk(entry.value, node.child(position++, entry.key)));
  }
  return {};
}

/// All elements of a list fill the same columns, so only their links and hashes mean something.
Status SeriesReader::walk_list(const idf::List& list, Node& node) {
  Node& element = node.child(0, "*");
  element.is_left_out = true;
  for (const idf::Data& value : list) ENGRAM_RETURN_IF_ERROR(walk(value, element));
  return {};
}

NumberColumn* SeriesReader::column_of(Node& node, size_t width, NumberColumn::Meaning meaning) {
  if (node.is_left_out || width == 0 || width > kMaxElements) return nullptr;
  if (!node.numbers) {
    if (width_ + width > kMaxWidth) return nullptr;
    width_ += width;
    node.numbers = block_.numbers.size();
    NumberColumn& added = block_.numbers.emplace_back();
    added.path = node.path;
    added.width = width;
    added.meaning = meaning;
    if (const idf::Quantity* quantity = node.type ? node.type->quantity() : nullptr) {
      added.unit = quantity->unit;
      added.minimum = quantity->minimum;
      added.maximum = quantity->maximum;
    }
  }
  NumberColumn& column = block_.numbers[*node.numbers];
  const auto row = static_cast<uint32_t>(block_.rows() - 1);
  const bool is_again = !column.rows.empty() && column.rows.back() == row;
  if (column.width != width || is_again) return nullptr;
  column.rows.push_back(row);
  held_ += width;
  return &column;
}

void SeriesReader::add_number(double number, Node& node, NumberColumn::Meaning meaning) {
  if (NumberColumn* column = column_of(node, 1, meaning)) column->values.push_back(number);
}

void SeriesReader::add_array(const idf::NdArray& array, Node& node) {
  mix(hash_of_bytes(array.bytes()), true);
  const bool is_turn = node.type ? node.type->kind() == idf::TypeKind::kOrientation ||
                                       node.type->kind() == idf::TypeKind::kQuaternion
                                 : node.key == "orientation" && array.count() == 4;
  const auto meaning =
      is_turn ? NumberColumn::Meaning::kOrientation : NumberColumn::Meaning::kQuantity;
  if (NumberColumn* column = column_of(node, static_cast<size_t>(array.count()), meaning))
    append_all(array, column->values);
}

Status SeriesReader::add_text(const std::string& text, Node& node) {
  // Without a type, what reads as the ID of a moment is taken for a link, as find_links does.
  const bool is_typed_link = node.type && node.type->kind() == idf::TypeKind::kMemoryLink;
  bool is_link = is_typed_link && !text.empty();
  LinkTarget target;
  if (is_link || (!node.type && text.find('/') != std::string::npos)) {
    ENGRAM_ASSIGN_OR_RETURN(target, targets_->find(text));
    is_link = is_link || target.has_time;
  }
  const uint64_t hash = std::hash<std::string>{}(text);
  mix(hash, !is_link && !is_typed_link);
  if (!is_link) return {};
  block_.has_identity = block_.has_identity || target.has_time;
  if (!node.links) {
    node.links = block_.links.size();
    block_.links.emplace_back().path = node.path;
  }
  LinkColumn& column = block_.links[*node.links];
  const auto row = static_cast<uint32_t>(block_.rows() - 1);
  column.rows.push_back(row);
  column.targets.push_back(target);
  held_ += 3;
  if (target.state != LinkTarget::State::kFound && column.dead.size() < kMaxDeadTexts)
    column.dead.emplace_back(row, text);
  return {};
}

SeriesBlock SeriesReader::take() {
  SeriesBlock next{block_.entity, block_.instance, block_.is_periodic, block_.step_s};
  next.has_identity = block_.has_identity;
  for (const NumberColumn& column : block_.numbers)
    next.numbers.push_back({column.path,
                            column.width,
                            column.meaning,
                            column.unit,
                            column.minimum,
                            column.maximum,
                            {},
                            {}});
  for (const LinkColumn& column : block_.links) next.links.push_back({column.path, {}, {}, {}});
  held_ = 0;
  SeriesBlock done = std::exchange(block_, std::move(next));
  for (NumberColumn& column : done.numbers) order_by_element(column);
  return done;
}

}  // namespace engram::ltm
