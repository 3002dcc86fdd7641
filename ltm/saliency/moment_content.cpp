// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/moment_content.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "ltm/idf/element_visit.h"
#include "ltm/memory/told_events.h"

namespace engram::ltm {

namespace {

/// Nanoseconds since 1970 of January 12th 1970: counts stay below, times of robots above.
constexpr int64_t kMinTime = 1'000'000'000'000'000;
constexpr int kMaxContentDepth = 64;

/// Whether an integer can be a time alone. The smallest integer has no magnitude, so both ends are
/// compared.
bool is_time(int64_t value) {
  return value >= kMinTime || value <= -kMinTime;
}

/// The elements as numbers; empty if some of them are times.
std::vector<double> numbers_of(const idf::NdArray& array) {
  std::vector<double> numbers;
  idf::visit_element_type(array.type(), [&]<typename T>(T) {
    for (const T value : array.values<T>()) {
      if constexpr (sizeof(T) == sizeof(int64_t) && std::is_integral_v<T>)
        if (is_time(static_cast<int64_t>(value))) return numbers.clear();
      const auto number = static_cast<double>(value);
      numbers.push_back(std::isfinite(number) ? number : 0);
    }
  });
  return numbers;
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
  const ToldEvents told = told_events(value, type_);
  content_.is_speech = content_.is_speech || told.is_speech;
  if (content_.outcome == ActionOutcome::kUnknown) content_.outcome = told.outcome;
  if (told.links != 0) content_.links = (std::rotl(content_.links, 23) ^ told.links) + 1;
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
  if (depth_ >= kMaxContentDepth) return;
  ++depth_;
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
    if (whole == nullptr || !is_time(*whole)) add_number(*number, path);
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
    // An element without texts tells no facts, however many there are of them.
    if (elements.content_.facts != 0)
      content_.facts = (std::rotl(content_.facts, 23) ^ elements.content_.facts) + 1;
  }
  add_number(static_cast<double>(list.size()), path + "[]");
  for (const auto& [member, sum] : sums) add_number(sum.first / sum.second, path + "[]/" + member);
}

void ContentReader::add_array(const idf::NdArray& array, const std::string& path) {
  const bool is_image = array.type() == idf::ElementType::kUInt8;
  if (is_image || array.count() == 0 || array.count() > kMaxElements) return;
  add(path, numbers_of(array));
}

void ContentReader::add_number(double number, const std::string& path) {
  if (begin_member(path, 1)) content_.numbers.push_back(std::isfinite(number) ? number : 0);
}

void ContentReader::add_text(const std::string& text, const std::string& path) {
  if (linked_entity(text)) return;  // told_events() has read it.
  content_.facts = mixed_text(mixed_text(content_.facts + 1, path), text);
}

}  // namespace engram::ltm
