// SPDX-License-Identifier: Apache-2.0
// kitchen_main write FILE: writes the filled scene, an object of generated C++.
// kitchen_main check FILE: reads what Python made of it, and says whether it is that.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string_view>

#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "tests/ltm/typed/kitchen_values.h"

namespace {

namespace fs = std::filesystem;
using namespace engram;

/// What cross_test.py changes.
kitchen::Scene changed_scene() {
  kitchen::Scene scene = typed::filled_scene();
  scene.stamp += std::chrono::nanoseconds(1);
  scene.cup.name += " of Python";
  scene.cup.fill = kitchen::Fill::None;
  scene.cup.pose_world_thing.position.y() = 7.5f;
  scene.maybe_cup.reset();
  scene.cups.push_back(scene.cup);
  scene.fills["neu"] = kitchen::Fill::EMPTY;
  scene.numbers.maybe_double = 1e-300;
  scene.arrays.matrix_3_4 = 2 * scene.arrays.matrix_3_4;
  scene.sensors.rgb = scene.sensors.rgb.clone();
  scene.sensors.rgb.at<cv::Vec3b>(1, 2)[0] = 200;
  scene.words.class_ = -5;
  return scene;
}

Status write(const fs::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(typed::filled_scene().to_idf()));
  return replace_file(path, bytes);
}

Status check(const fs::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(path));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data data, idf::decode(bytes));
  ENGRAM_ASSIGN_OR_RETURN(const auto scene, kitchen::Scene::from_idf(data));
  const kitchen::Scene expected = changed_scene();
  if (scene == expected) return {};
  const idf::Data needed = expected.to_idf();
  for (const auto& [key, value] : needed.get<idf::Dict>())
    if (const idf::Data* found = data.at(key); found == nullptr || !(*found == value))
      return invalid_argument("'{}' is not as it was made", key);
  return invalid_argument("the scene is not as it was made");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("needs write FILE or check FILE\n", stderr);
    return 2;
  }
  const Status status = std::string_view(argv[1]) == "write" ? write(argv[2]) : check(argv[2]);
  if (status.ok()) return 0;
  fmt::print(stderr, "{}\n", status.to_string());
  return 1;
}
