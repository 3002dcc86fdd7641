// SPDX-License-Identifier: Apache-2.0
#include "speech/noticing/hand_joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "ltm/core/ascii.h"

namespace engram::speech {

namespace {

constexpr size_t kMaxNumbers = 1024;

/// What members are called that tell of joints, and of something else than where they are.
constexpr std::array<std::string_view, 7> kNoTurn{"velocit", "speed",   "effort",     "torque",
                                                  "current", "acceler", "temperature"};
constexpr std::array<std::string_view, 8> kFingers{"hand",   "finger", "thumb", "index",
                                                   "middle", "ring",   "pinky", "little"};

bool has_any(std::string_view text, std::span<const std::string_view> parts) {
  return std::any_of(parts.begin(), parts.end(), [text](std::string_view part) {
    return text.find(part) != std::string_view::npos;
  });
}

/// The words of a name: "kRightHandIndex" and "right_hand_index" as "right hand index".
std::vector<std::string> words_in(const std::string& name) {
  std::vector<std::string> words(1);
  for (size_t i = 0; i < name.size(); ++i) {
    const bool is_letter = std::isalpha(static_cast<unsigned char>(name[i])) != 0;
    const bool is_upper = std::isupper(static_cast<unsigned char>(name[i])) != 0;
    const bool was_lower = i > 0 && std::islower(static_cast<unsigned char>(name[i - 1])) != 0;
    if ((!is_letter || (is_upper && was_lower)) && !words.back().empty()) words.emplace_back();
    if (is_letter) words.back() += name[i];
  }
  for (std::string& word : words) word = lower_ascii(word);
  return words;
}

/// Calls `visit` with the name of each number and the number.
template <typename Visit>
void visit_numbers(const idf::Data& value, const std::string& path, const Visit& visit) {
  if (has_any(lower_ascii(path), kNoTurn)) return;
  if (const auto* dict = value.get_if<idf::Dict>()) {
    for (const idf::DictEntry& member : *dict)
      visit_numbers(member.value, path.empty() ? member.key : path + "." + member.key, visit);
    return;
  }
  if (value.is<double>() || value.is<float>()) return visit(path, 0, 1, *value.as_number());
  const auto* array = value.get_if<idf::NdArray>();
  if (array == nullptr || array->count() > static_cast<int64_t>(kMaxNumbers)) return;
  const auto count = static_cast<size_t>(array->count());
  const auto visit_all = [&](const auto& numbers) {
    for (size_t i = 0; i < count; ++i) visit(path, i, count, static_cast<double>(numbers[i]));
  };
  if (array->type() == idf::ElementType::kFloat32) visit_all(array->values<float>());
  if (array->type() == idf::ElementType::kFloat64) visit_all(array->values<double>());
}

}  // namespace

std::vector<double> joint_numbers(const idf::Data& value) {
  std::vector<double> numbers;
  visit_numbers(value, {}, [&](const std::string&, size_t, size_t, double number) {
    numbers.push_back(number);
  });
  if (numbers.size() > kMaxNumbers) numbers.clear();
  return numbers;
}

std::vector<std::string> joint_names(const idf::Data& value,
                                     const std::vector<std::string>& described) {
  std::vector<std::string> names;
  visit_numbers(value, {}, [&](const std::string& path, size_t index, size_t count, double) {
    if (count == 1)
      names.push_back(path);
    else
      names.push_back(described.size() == count ? described[index] : std::string());
  });
  return names;
}

std::vector<HandJoints> hands_among(const std::vector<std::string>& names) {
  std::map<std::string, HandJoints> hands;
  std::map<std::string, std::vector<size_t>> thumbs;
  for (size_t i = 0; i < names.size(); ++i) {
    const std::vector<std::string> words = words_in(names[i]);
    const auto has = [&](std::string_view word) {
      return std::find(words.begin(), words.end(), word) != words.end();
    };
    const bool is_gripper = has("gripper") || has("jaw");
    const bool is_finger = std::any_of(kFingers.begin(), kFingers.end(), has);
    if (!is_gripper && !is_finger) continue;
    const std::string hand = has("left") || has("l")    ? "left"
                             : has("right") || has("r") ? "right"
                                                        : "gripper";
    HandJoints& joints = hands[hand];
    joints.hand = hand;
    joints.is_gripper = joints.is_gripper || is_gripper;
    (has("thumb") ? thumbs[hand] : joints.columns).push_back(i);
  }
  std::vector<HandJoints> list;
  for (auto& [name, joints] : hands) {
    if (joints.columns.empty()) joints.columns = thumbs[name];
    list.push_back(std::move(joints));
  }
  return list;
}

std::optional<double> mean_of(const HandJoints& hand, const std::vector<double>& numbers) {
  double sum = 0;
  for (const size_t column : hand.columns) {
    if (column >= numbers.size() || !std::isfinite(numbers[column])) return {};
    sum += numbers[column];
  }
  return sum / static_cast<double>(hand.columns.size());
}

}  // namespace engram::speech
