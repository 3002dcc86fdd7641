// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/seen_image.h"

#include <algorithm>

#include "ltm/memory/links.h"

namespace engram::ltm {

namespace {

constexpr size_t kMaxViewNumbers = 1024;

/// An image for a camera's purpose: matrices of small numbers are none, whatever their size.
bool is_picture(const idf::NdArray& array) {
  const auto size = image_size_of(array);
  if (!size) return false;
  return array.type() == idf::ElementType::kUInt8 || (array.rank() == 3 && size->channels == 1);
}

const idf::NdArray* first_image(const idf::Data& value) {
  if (const auto* array = value.get_if<idf::NdArray>()) return is_picture(*array) ? array : nullptr;
  if (const auto* dict = value.get_if<idf::Dict>()) {
    for (const idf::DictEntry& entry : *dict)
      if (const idf::NdArray* found = first_image(entry.value)) return found;
  } else if (const auto* list = value.get_if<idf::List>()) {
    for (const idf::Data& element : *list)
      if (const idf::NdArray* found = first_image(element)) return found;
  }
  return nullptr;
}

template <typename T>
void append_elements(const idf::NdArray& array, std::vector<double>& numbers) {
  for (const T value : array.values<T>()) numbers.push_back(static_cast<double>(value));
}

void append_array(const idf::NdArray& array, std::vector<double>& numbers) {
  if (array.count() > static_cast<int64_t>(kMaxViewNumbers - numbers.size())) return;
  if (array.type() == idf::ElementType::kFloat64) append_elements<double>(array, numbers);
  if (array.type() == idf::ElementType::kFloat32) append_elements<float>(array, numbers);
}

void append_numbers(const idf::Data& value, std::vector<double>& numbers) {
  if (const auto* array = value.get_if<idf::NdArray>()) {
    append_array(*array, numbers);
  } else if (const auto* dict = value.get_if<idf::Dict>()) {
    for (const idf::DictEntry& entry : *dict) append_numbers(entry.value, numbers);
  } else if (const auto* list = value.get_if<idf::List>()) {
    for (const idf::Data& element : *list) append_numbers(element, numbers);
  } else if (value.is<float>() || value.is<double>()) {
    if (numbers.size() < kMaxViewNumbers) numbers.push_back(*value.as_number());
  }
}

}  // namespace

const idf::NdArray* image_of(const SnapshotResult& snapshot) {
  return snapshot.instances.empty() ? nullptr : first_image(snapshot.instances.front().data);
}

Result<std::optional<SeenImage>> see(EntityPast& past, Time moment) {
  const auto snapshot = past.read(moment, Prefer::kRecorded);
  if (snapshot.status().code() == StatusCode::kDataLoss) return std::optional<SeenImage>();
  ENGRAM_RETURN_IF_ERROR(snapshot.status());
  const idf::NdArray* const image = image_of(snapshot->answer);
  if (image == nullptr) return std::optional<SeenImage>();
  ENGRAM_ASSIGN_OR_RETURN(auto descriptor, describe_image(*image));
  return std::optional<SeenImage>({*image_size_of(*image), std::move(descriptor)});
}

Result<std::vector<MemoryId>> linked_entities(KnownPast& past, const MemoryId& entity,
                                              const SnapshotResult& snapshot) {
  std::vector<MemoryId> linked;
  if (snapshot.instances.empty()) return linked;
  const idf::Data& value = snapshot.instances.front().data;
  const auto type = past.type_of(entity);
  for (const Link& link : type ? find_links(value, *type) : find_links(value)) {
    if (!link.id.has_entity()) continue;
    MemoryId target = link.id.entity();
    if (target == entity || std::ranges::find(linked, target) != linked.end()) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto other, past.of(target));
    if (other == nullptr) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto numbers, numbers_at(*other, snapshot.time));
    if (!numbers.empty()) linked.push_back(std::move(target));
  }
  return linked;
}

Result<std::vector<double>> numbers_at(EntityPast& past, Time moment) {
  std::vector<double> numbers;
  ENGRAM_ASSIGN_OR_RETURN(const auto at, past.at_or_before(moment));
  if (!at) return numbers;
  const auto snapshot = past.read(*at, Prefer::kRecorded);
  if (snapshot.status().code() == StatusCode::kDataLoss) return numbers;
  ENGRAM_RETURN_IF_ERROR(snapshot.status());
  if (!snapshot->answer.instances.empty())
    append_numbers(snapshot->answer.instances.front().data, numbers);
  return numbers;
}

}  // namespace engram::ltm
