// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/moment_content.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "ltm/likeness/image_descriptor.h"
#include "ltm/memory/told_events.h"

namespace engram::ltm {

namespace {

/// Nanoseconds since 1970 of January 12th 1970: counts stay below, times of robots above.
constexpr int64_t kMinTime = 1'000'000'000'000'000;
constexpr int kMaxContentDepth = 64;

template <typename T>
void append_elements_of(const idf::NdArray& array, std::vector<double>& numbers) {
  for (const T value : array.values<T>()) numbers.push_back(static_cast<double>(value));
}

bool append_any(const idf::NdArray& array, std::vector<double>& numbers) {
  switch (array.type()) {
    case idf::ElementType::kFloat64:
      append_elements_of<double>(array, numbers);
      return true;
    case idf::ElementType::kFloat32:
      append_elements_of<float>(array, numbers);
      return true;
    case idf::ElementType::kInt32:
      append_elements_of<int32_t>(array, numbers);
      return true;
    default:
      return false;
  }
}

}  // namespace

void ContentReader::begin() {
  content_ = {};
  members_.clear();
  instance_ = 0;
}

void ContentReader::add(const idf::Data& value) {
  depth_ = 0;
  const std::string path = instance_ == 0 ? "" : "[" + std::to_string(instance_) + "]";
  ++instance_;
  walk(value, path);
  if (content_.outcome == ActionOutcome::kUnknown) content_.outcome = outcome_in(value, type_);
}

void ContentReader::add(const std::string& path, const std::vector<double>& numbers) {
  if (!begin_member(path, numbers.size())) return;
  content_.numbers.insert(content_.numbers.end(), numbers.begin(), numbers.end());
}

bool ContentReader::begin_member(const std::string& path, size_t width) {
  if (width == 0 || content_.numbers.size() + width > kMaxNumbers) return false;
  members_.push_back({path, content_.numbers.size(), width});
  return true;
}

void ContentReader::walk(const idf::Data& value, const std::string& path) {
  if (++depth_ > kMaxContentDepth) return;
  if (const auto* array = value.get_if<idf::NdArray>()) {
    add_array(*array, path);
  } else if (const auto* dict = value.get_if<idf::Dict>()) {
    for (const idf::DictEntry& entry : *dict)
      walk(entry.value, path.empty() ? entry.key : path + "/" + entry.key);
  } else if (const auto* list = value.get_if<idf::List>()) {
    walk_list(*list, path);
  } else if (const auto* text = value.get_if<std::string>()) {
    add_text(*text, path);
  } else if (const auto number = value.as_number()) {
    const auto* whole = value.get_if<int64_t>();
    if (whole == nullptr || std::abs(*whole) < kMinTime) add_number(*number, path);
  }
  --depth_;
}

/// Elements of lists come and go, so their numbers are not compared one by one.
void ContentReader::walk_list(const idf::List& list, const std::string& path) {
  ContentReader elements(type_);
  std::map<std::string, std::pair<double, double>> sums;
  for (const idf::Data& element : list) {
    elements.begin();
    elements.depth_ = depth_;
    elements.walk(element, "");
    for (const ContentMember& member : elements.members_)
      for (size_t i = 0; i < member.width; ++i) {
        auto& [sum, count] = sums[member.path + "[" + std::to_string(i) + "]"];
        sum += elements.content_.numbers[member.first + i];
        count += 1;
      }
    content_.facts = (std::rotl(content_.facts, 23) ^ elements.content_.facts) + 1;
    content_.links = (std::rotl(content_.links, 23) ^ elements.content_.links) + 1;
  }
  add_number(static_cast<double>(list.size()), path + "[]");
  for (const auto& [member, sum] : sums) add_number(sum.first / sum.second, path + "[]/" + member);
}

void ContentReader::add_array(const idf::NdArray& array, const std::string& path) {
  if (array.count() == 0 || array.count() > kMaxElements) return;
  if (!begin_member(path, static_cast<size_t>(array.count()))) return;
  if (!append_any(array, content_.numbers)) {
    members_.pop_back();
    return;
  }
  for (size_t i = members_.back().first; i < content_.numbers.size(); ++i)
    if (!std::isfinite(content_.numbers[i])) content_.numbers[i] = 0;
}

void ContentReader::add_number(double number, const std::string& path) {
  if (begin_member(path, 1)) content_.numbers.push_back(std::isfinite(number) ? number : 0);
}

void ContentReader::add_text(const std::string& text, const std::string& path) {
  if (const auto entity = linked_entity(text)) {
    content_.links = mixed_text(mixed_text(content_.links + 1, path), entity->to_string());
    return;
  }
  content_.facts = mixed_text(mixed_text(content_.facts + 1, path), text);
  if (!text.empty() && is_speech_member(path)) content_.is_speech = true;
}

}  // namespace engram::ltm
