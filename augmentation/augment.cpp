// SPDX-License-Identifier: Apache-2.0
#include "augmentation/augment.h"

#include <algorithm>
#include <charconv>

#include "augmentation/image_changes.h"
#include "augmentation/scene_images.h"
#include "ltm/idf/type.h"

namespace engram::augmentation {

namespace {

bool is_image(const idf::TensorMember& member) {
  return member.kind == idf::MemberKind::kImage || member.kind == idf::MemberKind::kDepth;
}

bool contains(const std::vector<std::string>& paths, const std::string& path) {
  return std::ranges::find(paths, path) != paths.end();
}

PixelRole role_of(const idf::TensorMember& member, const SceneMembers& members) {
  if (contains(members.labels, member.path)) return PixelRole::kLabel;
  return member.type == idf::ElementType::kUInt8 ? PixelRole::kLight : PixelRole::kDepth;
}

idf::Layout layout_of(const idf::Data& value, const idf::Type* type) {
  const idf::Layout layout = idf::Layout::of(value);
  if (type == nullptr) return layout;
  return layout.with_kinds_of(idf::Layout::of(value, *type, idf::FreeSizes::kOfValue));
}

/// Errors: kInvalidArgument if a path leads to no member of the right kind.
Status check_members(const idf::Data& value, const SceneMembers& members) {
  for (const std::string& path : members.labels) {
    const idf::Data* found = value.at(path);
    const auto* array = found == nullptr ? nullptr : found->get_if<idf::NdArray>();
    if (array == nullptr || array->type() == idf::ElementType::kFloat32 ||
        array->shape().size() != 3 || array->shape()[2] != 1)
      return invalid_argument("labels '{}': found {}, needs uint8 or uint16 [H, W, 1]", path,
                              found == nullptr   ? "nothing"
                              : array == nullptr ? std::string(found->kind_name())
                                                 : idf::to_string(array->shape()));
  }
  return {};
}

template <typename T>
std::vector<double> widened(const idf::NdArray& array) {
  const auto values = array.values<T>();
  return {values.begin(), values.end()};
}

Result<ScenePoints> points_of(const idf::Data& value, const std::string& path) {
  const idf::Data* found = value.at(path);
  const auto* array = found == nullptr ? nullptr : found->get_if<idf::NdArray>();
  const bool is_paired =
      array != nullptr && !array->shape().empty() && array->shape().back() % 2 == 0;
  if (is_paired && array->type() == idf::ElementType::kFloat64)
    return ScenePoints{path, widened<double>(*array)};
  if (is_paired && array->type() == idf::ElementType::kFloat32)
    return ScenePoints{path, widened<float>(*array)};
  return invalid_argument("points '{}': found {}, needs float32 or float64 of x, y pairs", path,
                          found == nullptr   ? "nothing"
                          : array == nullptr ? std::string(found->kind_name())
                                             : idf::to_string(array->shape()));
}

idf::NdArray to_array(const std::vector<double>& numbers, const idf::NdArray& as) {
  if (as.type() == idf::ElementType::kFloat64) return idf::NdArray::take(as.shape(), numbers);
  return idf::NdArray::take(as.shape(), std::vector<float>(numbers.begin(), numbers.end()));
}

Result<SceneImages> scene_of(const idf::Data& value, const idf::Type* type,
                             const SceneMembers& members,
                             const std::optional<idf::NdArray>& labels) {
  ENGRAM_RETURN_IF_ERROR(check_members(value, members));
  SceneImages scene;
  const idf::Layout layout = layout_of(value, type);
  for (const idf::TensorMember& member : layout.members()) {
    if (!is_image(member) && !contains(members.labels, member.path)) continue;
    auto pixels = to_mat(value.at(member.path)->get<idf::NdArray>());
    if (!pixels.ok()) return pixels.status().with_context("member '" + member.path + "'");
    scene.images.push_back({member.path, role_of(member, members), *std::move(pixels)});
  }
  for (const std::string& path : members.points) {
    ENGRAM_ASSIGN_OR_RETURN(ScenePoints points, points_of(value, path));
    scene.points.push_back(std::move(points));
  }
  if (!labels) return scene;
  auto pixels = to_mat(*labels);
  if (!pixels.ok() || pixels->channels() != 1 || pixels->depth() == CV_32F)
    return invalid_argument("labels: found {} {}, needs uint8 or uint16 [H, W, 1]",
                            to_string(labels->type()), idf::to_string(labels->shape()));
  scene.labels = *std::move(pixels);
  return scene;
}

Status apply(const Change& change, SceneImages& scene) {
  ENGRAM_ASSIGN_OR_RETURN(const ImageChange* kind, find_image_change(change.name));
  ENGRAM_ASSIGN_OR_RETURN(const Parameters parameters, check_parameters(*kind, change));
  // Without labels the change would silently do nothing, and the recipe would claim that it did.
  if (kind->needs_mask() && scene.mask_of(0, {1, 1}).empty())
    return invalid_argument("change '{}': found no labels, needs to be told where the object is",
                            change.name);
  kind->apply(parameters, scene);
  return {};
}

}  // namespace

Result<ChangeChoice> parse_change_choice(std::string_view text, int strength_percent) {
  const size_t colon = text.find(':');
  ChangeChoice choice{nullptr, strength_percent};
  ENGRAM_ASSIGN_OR_RETURN(choice.kind, find_image_change(text.substr(0, colon)));
  if (colon != std::string_view::npos) {
    const std::string_view number = text.substr(colon + 1);
    const auto [end, error] =
        std::from_chars(number.data(), number.data() + number.size(), choice.strength_percent);
    if (error != std::errc() || end != number.data() + number.size()) choice.strength_percent = 0;
  }
  if (choice.strength_percent < 1 || choice.strength_percent > 100)
    return invalid_argument("change '{}': needs a strength of 1 to 100, as in 'rotate:50'", text);
  return choice;
}

std::vector<ChangeChoice> usual_changes(int strength_percent, bool has_mask) {
  std::vector<ChangeChoice> choices;
  for (const auto& kind : all_image_changes())
    if (has_mask || !kind->needs_mask()) choices.push_back({kind.get(), strength_percent});
  return choices;
}

Recipe draw_recipe(std::span<const ChangeChoice> choices, int64_t label, Random& random) {
  ENGRAM_CHECK(!choices.empty(), "a recipe needs changes to choose from");
  const auto sure =
      static_cast<size_t>(random.between(0, static_cast<int64_t>(choices.size()) - 1));
  Recipe recipe;
  for (const auto& kind : all_image_changes())
    for (size_t i = 0; i < choices.size(); ++i) {
      if (choices[i].kind != kind.get()) continue;
      // Both draws happen even if the change is not taken, so the parameters of one change do not
      // depend on which others are in the recipe.
      const bool is_taken = random.between(0, 1) == 1 || i == sure;
      const Parameters drawn = kind->draw(random, choices[i].strength_percent);
      if (!is_taken) continue;
      Change& change = recipe.changes.emplace_back(Change{std::string(kind->name()), {}});
      for (const Parameter& parameter : kind->parameters())
        change.parameters.set(parameter.name,
                              parameter.name == "label" ? label : drawn.at(parameter.name));
    }
  return recipe;
}

Recipe with_seed(Recipe recipe, uint64_t seed) {
  for (Change& change : recipe.changes)
    if (change.parameters.find("seed") != nullptr)
      change.parameters.set("seed", static_cast<int64_t>(seed & static_cast<uint64_t>(kMaxSeed)));
  return recipe;
}

bool has_images(const idf::Layout& layout) {
  return std::ranges::any_of(layout.members(), is_image);
}

Result<idf::Data> augmented(const idf::Data& value, const idf::Type* type, const Recipe& recipe,
                            const SceneMembers& members,
                            const std::optional<idf::NdArray>& labels) {
  ENGRAM_ASSIGN_OR_RETURN(SceneImages scene, scene_of(value, type, members, labels));
  if (scene.images.empty()) return invalid_argument("found no image in the value, needs one");
  for (const Change& change : recipe.changes) ENGRAM_RETURN_IF_ERROR(apply(change, scene));
  // Everything else stays as it was: joints and other numbers do not know how the camera stood.
  idf::Data changed = value;
  for (const SceneImage& image : scene.images) {
    idf::Data* place = changed.at(image.path);
    *place = to_array(image.pixels, place->get<idf::NdArray>());
  }
  for (const ScenePoints& points : scene.points) {
    idf::Data* place = changed.at(points.path);
    *place = to_array(points.coordinates, place->get<idf::NdArray>());
  }
  return changed;
}

}  // namespace engram::augmentation
