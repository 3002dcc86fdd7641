// SPDX-License-Identifier: Apache-2.0
#include "encoders/coded_weights.h"

#include "encoders/coding/background_coder.h"
#include "encoders/coding/byte_stream.h"
#include "encoders/coding/weight_coder.h"
#include "encoders/model_vectors.h"

namespace engram::encoders {

namespace {

constexpr const char* kMatricesPath = "/weights/matrices";
constexpr const char* kBackgroundsPath = "/weights/backgrounds";

void put_part(const std::vector<std::byte>& bytes, ByteWriter& writer) {
  writer.put_varint(static_cast<int64_t>(bytes.size()));
  for (const std::byte each : bytes) writer.put(std::to_integer<uint8_t>(each));
}

Status write_parts(h5::File& file, const std::string& path, ByteWriter& writer) {
  const std::vector<std::byte> bytes = writer.take();
  const auto* first = reinterpret_cast<const uint8_t*>(bytes.data());
  return write_vector(file, path, std::vector<uint8_t>(first, first + bytes.size()));
}

/// Removes the next part from `bytes` and returns it.
Result<std::span<const std::byte>> next_part(std::span<const std::byte>& bytes,
                                             const std::string& name) {
  ByteReader reader(bytes);
  const int64_t size = reader.get_varint();
  const auto rest = reader.rest();
  if (reader.failed() || size < 0 || static_cast<uint64_t>(size) > rest.size())
    return data_loss("weights of '{}': found {} bytes of them, needs at most {}", name, size,
                     rest.size());
  bytes = rest.subspan(static_cast<size_t>(size));
  return rest.first(static_cast<size_t>(size));
}

/// Reads all parts of a dataset. `decode(bytes, shape)` returns the values of one part.
template <typename Value, typename Shape, typename Decode>
Result<std::vector<Value>> read_parts(const h5::File& file, const std::string& path,
                                      std::span<const Shape> shapes, Decode decode) {
  ENGRAM_ASSIGN_OR_RETURN(const auto stored, read_vector<uint8_t>(file, path));
  auto bytes = std::as_bytes(std::span(stored));
  std::vector<Value> values;
  for (const Shape& shape : shapes) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, next_part(bytes, shape.name));
    ENGRAM_ASSIGN_OR_RETURN(const std::vector<Value> some, decode(part, shape));
    values.insert(values.end(), some.begin(), some.end());
  }
  if (!bytes.empty())
    return data_loss("found {} bytes of weights more than the layout needs", bytes.size());
  return values;
}

}  // namespace

Status write_matrices(h5::File& file, std::span<const MatrixShape> shapes,
                      std::span<const int8_t> weights) {
  ByteWriter writer;
  WeightCoder coder;
  for (const MatrixShape& shape : shapes) {
    const size_t count = shape.rows * shape.columns;
    put_part(coder.encode(weights.first(count), shape.columns), writer);
    weights = weights.subspan(count);
  }
  return write_parts(file, kMatricesPath, writer);
}

Result<std::vector<int8_t>> read_matrices(const h5::File& file,
                                          std::span<const MatrixShape> shapes) {
  WeightCoder coder;
  return read_parts<int8_t>(file, kMatricesPath, shapes,
                            [&](std::span<const std::byte> bytes, const MatrixShape& shape) {
                              return coder.decode(bytes, shape.rows, shape.columns, shape.name);
                            });
}

Status write_backgrounds(h5::File& file, std::span<const ScenesShape> shapes,
                         std::span<const uint8_t> pixels) {
  ByteWriter writer;
  for (const ScenesShape& shape : shapes) {
    const size_t count = shape.scenes * shape.shape.count();
    put_part(encode_backgrounds(pixels.first(count), shape.shape), writer);
    pixels = pixels.subspan(count);
  }
  return write_parts(file, kBackgroundsPath, writer);
}

Result<std::vector<uint8_t>> read_backgrounds(const h5::File& file,
                                              std::span<const ScenesShape> shapes) {
  return read_parts<uint8_t>(file, kBackgroundsPath, shapes,
                             [](std::span<const std::byte> bytes, const ScenesShape& shape) {
                               return decode_backgrounds(bytes, shape.scenes, shape.shape,
                                                         shape.name);
                             });
}

}  // namespace engram::encoders
