// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace engram::ltm::testing {

/// Writes the few messages of ONNX (protocol buffers) that a small network needs.
class OnnxWriter {
 public:
  static std::string varint(uint64_t value) {
    std::string bytes;
    for (; value >= 128; value >>= 7) bytes += static_cast<char>(value % 128 + 128);
    return bytes + static_cast<char>(value);
  }
  static std::string number(int field, uint64_t value) {
    return varint(static_cast<uint64_t>(field) << 3) + varint(value);
  }
  static std::string bytes(int field, const std::string& value) {
    return varint(static_cast<uint64_t>(field) << 3 | 2) + varint(value.size()) + value;
  }
  static std::string ints_attribute(const std::string& name, const std::vector<int64_t>& values) {
    std::string all = bytes(1, name);
    for (const int64_t value : values) all += number(8, static_cast<uint64_t>(value));
    return bytes(5, all + number(20, 7));
  }
  static std::string node(const std::string& kind, const std::vector<std::string>& inputs,
                          const std::string& output, const std::string& attributes = "") {
    std::string all;
    for (const std::string& input : inputs) all += bytes(1, input);
    return bytes(1, all + bytes(2, output) + bytes(3, output) + bytes(4, kind) + attributes);
  }
  static std::string floats(const std::string& name, const std::vector<int64_t>& shape,
                            const std::vector<float>& values) {
    std::string raw(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    return tensor(name, shape, 1, raw);
  }
  static std::string integers(const std::string& name, const std::vector<int64_t>& values) {
    std::string raw(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(int64_t));
    return tensor(name, {static_cast<int64_t>(values.size())}, 7, raw);
  }
  static std::string value(int field, const std::string& name, const std::vector<int64_t>& shape) {
    std::string dims;
    for (const int64_t size : shape) dims += bytes(1, number(1, static_cast<uint64_t>(size)));
    return bytes(field, bytes(1, name) + bytes(2, bytes(1, number(1, 1) + bytes(2, dims))));
  }
  static std::string model(const std::string& graph) {
    return number(1, 7) + bytes(7, graph) + bytes(8, bytes(1, "") + number(2, 11));
  }

 private:
  static std::string tensor(const std::string& name, const std::vector<int64_t>& shape, int type,
                            const std::string& raw) {
    std::string all;
    for (const int64_t size : shape) all += number(1, static_cast<uint64_t>(size));
    return bytes(5, all + number(2, static_cast<uint64_t>(type)) + bytes(8, name) + bytes(9, raw));
  }
};

/// What may be wrong with a network.
enum class OnnxFault : uint8_t {
  kNone,
  kTransposed,  ///< [1, N, 5]
  kParts,       ///< Boxes in 0..1.
  kScores,      ///< Scores of 1 more than brightness.
  kNoNumber,    ///< Scores are no numbers where a cell is not black.
  kTwoOutputs,
};

/// Writes a network that finds bright cells: an input of `size` pixels is cut into `cells` x
/// `cells` cells, and each is a box whose score is its brightness.
inline std::filesystem::path bright_cells_onnx(const std::filesystem::path& folder, bool is_ssd,
                                               int size = 64, int cells = 4,
                                               OnnxFault fault = OnnxFault::kNone) {
  using W = OnnxWriter;
  const int64_t side = size / cells;
  const int64_t count = int64_t{cells} * cells;
  const int64_t rows = is_ssd ? 7 : 5;
  const int64_t score_row = is_ssd ? 2 : 4;
  // Each row of weights gives one number of a box; only the score looks at the image.
  std::vector<float> weights(static_cast<size_t>(rows * 3), 0.0f);
  for (int64_t c = 0; c < 3; ++c) weights[static_cast<size_t>(score_row * 3 + c)] = 1.0f / 3;
  std::vector<float> places(static_cast<size_t>(rows * count), 0.0f);
  for (int64_t i = 0; i < count; ++i) {
    const auto left = static_cast<float>(i % cells * side);
    const auto top = static_cast<float>(i / cells * side);
    const auto length = static_cast<float>(side);
    const auto at = [&](int64_t row) -> float& {
      return places[static_cast<size_t>(row * count + i)];
    };
    if (fault == OnnxFault::kScores) at(score_row) = 1;
    if (is_ssd) {
      const auto whole = static_cast<float>(size);
      at(1) = 1;
      at(3) = left / whole;
      at(4) = top / whole;
      at(5) = (left + length) / whole;
      at(6) = (top + length) / whole;
    } else {
      at(0) = left + length / 2;
      at(1) = top + length / 2;
      at(2) = length;
      at(3) = length;
      if (fault == OnnxFault::kParts)
        for (int64_t row = 0; row < 4; ++row) at(row) /= static_cast<float>(size);
    }
  }
  std::vector<float> factors(static_cast<size_t>(rows * count), 1.0f);
  if (fault == OnnxFault::kNoNumber) {
    // What is beyond all floats, times zero.
    std::fill_n(weights.begin() + score_row * 3, 3, std::numeric_limits<float>::max());
    std::fill_n(factors.begin() + score_row * count, count, 0.0f);
  }
  std::string graph =
      W::node("AveragePool", {"image"}, "cells",
              W::ints_attribute("kernel_shape", {side, side}) +
                  W::ints_attribute("strides", {side, side})) +
      W::node("Conv", {"cells", "weights"}, "scores", W::ints_attribute("kernel_shape", {1, 1})) +
      W::node("Reshape", {"scores", "flat"}, "rows") + W::node("Add", {"rows", "places"}, "placed");
  const bool is_turned = is_ssd || fault == OnnxFault::kTransposed;
  graph += W::node("Mul", {"placed", "factors"}, is_turned ? "columns" : "boxes");
  if (fault == OnnxFault::kTransposed)
    graph += W::node("Transpose", {"columns"}, "boxes", W::ints_attribute("perm", {0, 2, 1}));
  if (fault == OnnxFault::kTwoOutputs) graph += W::node("Relu", {"scores"}, "more");
  if (is_ssd)
    graph += W::node("Transpose", {"columns"}, "turned", W::ints_attribute("perm", {0, 2, 1})) +
             W::node("Reshape", {"turned", "four"}, "boxes");
  graph += W::bytes(2, "bright_cells");
  graph += W::floats("weights", {rows, 3, 1, 1}, weights);
  graph += W::floats("places", {1, rows, count}, places);
  graph += W::floats("factors", {1, rows, count}, factors);
  graph += W::integers("flat", {1, rows, count});
  if (is_ssd) graph += W::integers("four", {1, 1, count, 7});
  graph += W::value(11, "image", {1, 3, size, size});
  graph += is_ssd
               ? W::value(12, "boxes", {1, 1, count, 7})
               : W::value(12, "boxes",
                          fault == OnnxFault::kTransposed ? std::vector<int64_t>{1, count, rows}
                                                          : std::vector<int64_t>{1, rows, count});
  if (fault == OnnxFault::kTwoOutputs) graph += W::value(12, "more", {1, rows, cells, cells});
  const std::filesystem::path file = folder / (is_ssd ? "ssd.onnx" : "yolo.onnx");
  std::ofstream(file, std::ios::binary) << W::model(graph);
  return file;
}

}  // namespace engram::ltm::testing
