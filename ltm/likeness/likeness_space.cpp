// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/likeness_space.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ltm/codec/zstd.h"
#include "ltm/core/byte_fields.h"
#include "ltm/store/checksum.h"

namespace engram::ltm {

namespace {

constexpr uint32_t kSpaceVersion = 1;
constexpr size_t kMaxSpaceBytes = size_t{1} << 20;
constexpr uint32_t kMaxViews = 1024;

/// Weights are stored as 16-bit shares of the largest one, which is a tenth of the bytes of what
/// zstd makes of floats, and changes codes by less than their rounding.
struct Rounded {
  float unit = 0;
  std::vector<int16_t> shares;
};

Rounded rounded(std::span<const float> weights) {
  constexpr float kMaxShare = 32767;
  Rounded result;
  for (const float weight : weights) result.unit = std::max(result.unit, std::abs(weight));
  result.unit /= kMaxShare;
  for (const float weight : weights)
    result.shares.push_back(
        result.unit > 0 ? static_cast<int16_t>(std::lround(weight / result.unit)) : int16_t{0});
  return result;
}

void write_weights(FieldWriter<std::vector<std::byte>>& fields, std::span<const float> weights) {
  const Rounded whole = rounded(weights);
  fields.number(std::bit_cast<uint32_t>(whole.unit));
  fields.bytes(std::as_bytes(std::span(whole.shares)));
}

std::vector<float> read_weights(FieldReader& fields, size_t count) {
  const auto unit = std::bit_cast<float>(fields.number<uint32_t>());
  std::vector<int16_t> shares(count);
  fields.fill(std::as_writable_bytes(std::span(shares)));
  std::vector<float> weights;
  weights.reserve(count);
  for (const int16_t share : shares) weights.push_back(static_cast<float>(share) * unit);
  return weights;
}

}  // namespace

uint64_t LikenessSpace::id() const {
  return checksum(pack());
}

std::string LikenessSpace::name() const {
  return fmt::format("{:08x}", static_cast<uint32_t>(id()));
}

std::vector<int8_t> LikenessSpace::code(std::span<const float> descriptor) const {
  constexpr float kMaxNumber = 127;
  std::vector<float> centred(kDescriptorSize);
  std::ranges::transform(descriptor, mean, centred.begin(), std::minus<>());
  std::vector<int8_t> code;
  code.reserve(kCodeSize);
  for (size_t i = 0; i < kCodeSize; ++i) {
    const float* const row = projection.data() + i * kDescriptorSize;
    float sum = 0;
    for (size_t j = 0; j < kDescriptorSize; ++j) sum += row[j] * centred[j];
    code.push_back(static_cast<int8_t>(std::lround(std::clamp(sum, -kMaxNumber, kMaxNumber))));
  }
  return code;
}

std::vector<std::byte> LikenessSpace::pack() const {
  std::vector<std::byte> bytes;
  FieldWriter fields(bytes);
  fields.number(kSpaceVersion);
  for (const int64_t side : {size.width, size.height, size.channels}) fields.number(side);
  fields.number(snapshots);
  fields.number(recordings);
  fields.number(static_cast<uint32_t>(views.size()));
  for (const MemoryId& view : views) fields.text(view.to_string());
  write_weights(fields, mean);
  write_weights(fields, projection);
  return compress_zstd(bytes);
}

Result<LikenessSpace> LikenessSpace::unpack(std::span<const std::byte> bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const auto plain, decompress_zstd(bytes, kMaxSpaceBytes));
  FieldReader fields(plain);
  const auto version = fields.number<uint32_t>();
  LikenessSpace space;
  space.size.width = fields.number<int64_t>();
  space.size.height = fields.number<int64_t>();
  space.size.channels = fields.number<int64_t>();
  space.snapshots = fields.number<uint64_t>();
  space.recordings = fields.number<uint64_t>();
  const auto views = fields.number<uint32_t>();
  for (uint32_t i = 0; i < std::min(views, kMaxViews); ++i) {
    auto view = MemoryId::parse(fields.text());
    if (!view.ok()) return data_loss("a space of likeness names '{}'", view.status().message());
    space.views.push_back(*std::move(view));
  }
  space.mean = read_weights(fields, kDescriptorSize);
  space.projection = read_weights(fields, kCodeSize * kDescriptorSize);
  const auto is_finite = [](float weight) { return std::isfinite(weight); };
  if (version != kSpaceVersion || !fields.is_whole() || views > kMaxViews ||
      !std::ranges::all_of(space.mean, is_finite) ||
      !std::ranges::all_of(space.projection, is_finite))
    return data_loss("a space of likeness is damaged");
  return space;
}

}  // namespace engram::ltm
