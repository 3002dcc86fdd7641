// SPDX-License-Identifier: Apache-2.0
#include "tests/ltm/typed/kitchen_values.h"

#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace engram::typed {

namespace {

using kitchen::Fill;

template <typename T>
constexpr T kMax = std::numeric_limits<T>::max();
template <typename T>
constexpr T kMin = std::numeric_limits<T>::lowest();
template <typename T>
constexpr T kInf = std::numeric_limits<T>::infinity();

ltm::MemoryId id(const char* text) {
  return ltm::MemoryId::parse(text).value();
}

/// 0, 1, 2, ... from `first` on.
template <typename T>
idf::NdArray counted(idf::Shape shape, T first = T{}) {
  std::vector<T> values(*idf::size_bytes(idf::kElementTypeOf<T>, shape) / sizeof(T));
  std::iota(values.begin(), values.end(), first);
  return idf::NdArray::take<T>(std::move(shape), std::move(values));
}

template <typename Pixel>
cv::Mat picture(int rows, int cols, int type) {
  cv::Mat mat(rows, cols, type);
  const int count = cols * mat.channels();
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < count; ++i) mat.ptr<Pixel>(row)[i] = static_cast<Pixel>(7 * row + i + 1);
  return mat;
}

template <typename Cloud>
Cloud points(int count) {
  typename Cloud::Points numbers(count, Cloud::kFields);
  for (int i = 0; i < numbers.size(); ++i) numbers.data()[i] = 0.5f + static_cast<float>(i);
  return Cloud(std::move(numbers));
}

kitchen::Cup filled_cup(const char* name) {
  kitchen::Cup cup;
  cup.name = name;
  cup.pose_world_thing = {{1.5f, -2.0f, 0.25f}, {0.5f, 0.5f, -0.5f, 0.5f}};
  cup.mass = 0.3f;
  cup.material = kitchen::Material::STEEL;
  cup.height = 0.12f;
  cup.fill = Fill::FULL;
  cup.last_fill = Fill::class_;
  cup.seen_in = {id("Vision/RGB/head/cam/2022-02-18 13:06:56.492182/0"), id("Vision"),
                 id(R"(a\/b/c\\d)"), ltm::MemoryId()};
  cup.owner = id("Person/Name/face/ann");
  cup.borrower = id("Person/Name/face/Jürgen");
  return cup;
}

kitchen::Numbers filled_numbers() {
  kitchen::Numbers numbers;
  numbers.an_int = -7;
  numbers.bounded_int = 12;
  numbers.a_long = 1'000'000'000'000;
  numbers.bounded_long = -6;
  numbers.a_float = 1.5f;
  numbers.bounded_float = 0.25f;
  numbers.a_double = 3.141592653589793;
  numbers.bounded_double = -0.75;
  numbers.a_bool = true;
  numbers.a_string = "Tee \"grün\" 茶 🍵\n\t\\ \x01";
  numbers.a_time = time_from_ns(1'645'189'616'492'182'000);
  numbers.maybe_int = 0;
  numbers.maybe_long = -1;
  numbers.maybe_float = 0.0f;
  numbers.maybe_double = -0.0;
  numbers.maybe_bool = false;
  numbers.maybe_string = "";
  numbers.maybe_time = time_from_ns(0);
  return numbers;
}

kitchen::Arrays filled_arrays() {
  kitchen::Arrays arrays;
  arrays.int8_of_3 = counted<int8_t>({3}, -1);
  arrays.int16_of_2_free = counted<int16_t>({2, 4}, -3);
  arrays.int32_free = counted<int32_t>({5}, -2);
  arrays.int64_free = counted<int64_t>({2, 2}, -9);
  arrays.uint8_volume = counted<uint8_t>({2, 3, 4}, 9);
  arrays.uint16_free = counted<uint16_t>({70});
  arrays.uint32_free = counted<uint32_t>({1});
  arrays.uint64_free = counted<uint64_t>({3});
  arrays.float32_bounded = counted<float>({4}, 0.5f);
  arrays.float32_bounded = filled<float>({4}, 3.0f);
  arrays.float64_free = counted<double>({1, 2, 3}, 0.5);
  arrays.no_axes = filled<double>({}, 6.25);
  arrays.maybe_array = counted<float>({3, 2});
  arrays.position = counted<float>({3}, 1.0f);
  for (int i = 0; i < 12; ++i) arrays.matrix_3_4(i / 4, i % 4) = i + 0.125;
  arrays.matrix_3_1 << 1, 2, 3;
  arrays.matrix_1_3 << 7, 8, 9;
  arrays.matrix_free_2.resize(3, 2);
  arrays.matrix_free_2 << 1, 2, 3, 4, 5, 255;
  arrays.matrix_free.resize(2, 3);
  arrays.matrix_free << 1, 2, 3, 4, 5, 6;
  arrays.matrix_20_20(3, 17) = -300;
  arrays.maybe_matrix.emplace();
  *arrays.maybe_matrix << 1, 2, 3, 4;
  arrays.quaternion_f32 = {0.5f, -0.5f, 0.5f, 0.5f};
  arrays.quaternion_f64 = {2, 3, 4, 5};
  arrays.orientation_f32 = {0, 1, 0, 0};
  arrays.orientation_f64 = {0.6, 0, 0.8, 0};
  arrays.pose_world_f32 = {{1, 2, 3}, {0, 0, 1, 0}};
  arrays.pose_world_f64 = {{-1, 1e-9, 1e9}, {0.6, 0.8, 0, 0}};
  arrays.maybe_pose = {{4, 5, 6}, {0, 0, 0, 1}};
  return arrays;
}

kitchen::Sensors filled_sensors() {
  kitchen::Sensors sensors;
  sensors.rgb = picture<uint8_t>(5, 7, CV_8UC3);
  // A part of a wider picture: its rows do not follow each other in memory.
  sensors.rgb_fixed = picture<uint8_t>(9, 11, CV_8UC3)(cv::Rect(2, 3, 6, 4));
  sensors.mono = picture<uint8_t>(2, 3, CV_8UC1);
  sensors.depth_m = picture<float>(3, 2, CV_32FC1);
  sensors.depth_mm = picture<uint16_t>(10, 9, CV_16UC1);
  sensors.maybe_rgb = picture<uint8_t>(1, 1, CV_8UC3);
  sensors.cloud_xyz = points<decltype(sensors.cloud_xyz)>(3);
  sensors.cloud_xyzi = points<decltype(sensors.cloud_xyzi)>(1);
  sensors.cloud_xyzl = points<decltype(sensors.cloud_xyzl)>(2);
  sensors.cloud_rgb = points<decltype(sensors.cloud_rgb)>(2);
  sensors.cloud_rgba = points<decltype(sensors.cloud_rgba)>(2);
  sensors.cloud_rgbl = points<decltype(sensors.cloud_rgbl)>(2);
  sensors.cloud_normal = points<decltype(sensors.cloud_normal)>(2);
  sensors.cloud_rgb_normal = points<decltype(sensors.cloud_rgb_normal)>(2);
  sensors.maybe_cloud = points<PointCloud<idf::PointType::kXyz>>(1);
  return sensors;
}

kitchen::Containers filled_containers() {
  kitchen::Containers containers;
  containers.floats = {1.0f, -2.5f};
  containers.three_ints = {3, 2, 1};
  containers.bounded_ints = {5, 6};
  containers.two_turns[1] = {0, 1, 0, 0};
  containers.hundred_floats[99] = 2.0f;
  containers.maybe_strings = {"a", std::nullopt, ""};
  containers.grid = {{1.0, 2.0}, {}, {3.0}};
  containers.flags = {true, false, true};
  containers.images = {picture<uint8_t>(2, 2, CV_8UC1), cv::Mat()};
  containers.arrays_by_name = {{"a", counted<float>({2})}, {"ä", counted<float>({0})}};
  containers.longs_by_name = {{"", 1}, {"a/b", 2}, {"$c", 3}};
  containers.range = {-1.5, 2.5};
  containers.named_pose = {"here", {{1, 1, 1}, {0, 1, 0, 0}}};
  containers.mixed = {4, "mixed", Fill::None, {0.5, 0.5, 0.5, 0.5}};
  containers.lonely = {time_from_ns(5)};
  containers.maybe_list = std::vector<int32_t>{1, 2};
  containers.maybe_dict = std::map<std::string, bool, std::less<>>{{"yes", true}};
  containers.maybe_tuple = {1, 2};
  containers.maybe_pair = std::pair(3, std::optional(filled_cup("inner")));
  return containers;
}

odd::Words filled_words() {
  odd::Words words;
  int32_t next = 1;
  odd::Words::for_each_member([&](std::string_view, auto member) {
    if constexpr (std::is_same_v<decltype(member), int32_t odd::Words::*>) words.*member = next++;
  });
  words.list = {4, 5};
  words.dict = {{"class", 6}};
  words.str = "str";
  words.float_ = 0.5f;
  words.np = counted<float>({3});
  words.std = "std";
  return words;
}

kitchen::Scene extreme_scene() {
  kitchen::Scene scene;
  scene.stamp = time_from_ns(kMin<int64_t>);
  auto& numbers = scene.numbers;
  numbers.an_int = kMin<int32_t>;
  numbers.a_long = kMin<int64_t>;
  numbers.a_float = std::bit_cast<float>(0xffc12345u);
  numbers.a_double = std::bit_cast<double>(0x7ff8000000000abcu);
  numbers.a_time = time_from_ns(kMax<int64_t>);
  numbers.maybe_int = kMax<int32_t>;
  numbers.maybe_long = kMax<int64_t>;
  numbers.maybe_float = -kInf<float>;
  numbers.maybe_double = kInf<double>;
  numbers.a_string = std::string("\0zero", 5);
  auto& arrays = scene.arrays;
  arrays.int64_free = idf::NdArray::take<int64_t>({1, 2}, {kMin<int64_t>, kMax<int64_t>});
  arrays.uint64_free = idf::NdArray::take<uint64_t>({2}, {0, kMax<uint64_t>});
  arrays.float64_free = idf::NdArray::take<double>(
      {1, 1, 5}, {std::nan(""), kInf<double>, -0.0, kMax<double>, 5e-324});
  arrays.matrix_3_1 << std::nanf(""), -kInf<float>, -0.0f;
  arrays.int16_of_2_free = counted<int16_t>({2, 0});
  scene.containers.floats = {std::nanf(""), kInf<float>, -0.0f, 1e-45f};
  scene.containers.longs_by_name = {{"least", kMin<int64_t>}, {"most", kMax<int64_t>}};
  scene.sensors.depth_m = cv::Mat(3, 2, CV_32FC1, cv::Scalar(std::nan("")));
  return scene;
}

kitchen::Scene empty_scene() {
  kitchen::Scene scene = filled_scene();
  scene.cup.name.clear();
  scene.cup.last_fill.reset();
  scene.cup.seen_in.clear();
  scene.cup.owner = {};
  scene.cup.borrower.reset();
  scene.maybe_cup.reset();
  scene.cups.clear();
  scene.fills.clear();
  scene.cups_by_shelf = {{"empty", {}}};
  scene.arrays.float64_free = counted<double>({0, 5, 0});
  scene.arrays.maybe_matrix.reset();
  scene.sensors = {};
  scene.sensors.depth_m = cv::Mat(3, 0, CV_32FC1);
  scene.containers = {};
  scene.containers.grid = {{}};
  return scene;
}

}  // namespace

kitchen::Scene filled_scene() {
  kitchen::Scene scene;
  scene.stamp = time_from_ns(1'645'189'616'492'182'001);
  scene.cup = filled_cup("blue cup");
  scene.maybe_cup = filled_cup("Tasse für Käthe");
  scene.cups = {filled_cup("one"), kitchen::Cup()};
  scene.fills = {{"blue cup", Fill::FULL}, {"größte", Fill::EMPTY}};
  scene.cups_by_shelf = {{"high", {filled_cup("two")}}, {"low", {}}};
  scene.numbers = filled_numbers();
  scene.arrays = filled_arrays();
  scene.sensors = filled_sensors();
  scene.containers = filled_containers();
  scene.words = filled_words();
  return scene;
}

std::vector<NamedScene> kitchen_scenes() {
  return {{"kitchen_default", {}},
          {"kitchen_filled", filled_scene()},
          {"kitchen_extreme", extreme_scene()},
          {"kitchen_empty", empty_scene()}};
}

}  // namespace engram::typed
