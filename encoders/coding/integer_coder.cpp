// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/integer_coder.h"

#include <bit>

#include "encoders/coding/checked_block.h"

namespace engram::encoders {

namespace {

constexpr int kTrust = 12;  ///< How many integers a stored table is worth.

/// A port that writes nothing: what is left is learning.
struct Listener {
  static constexpr bool kIsDecoder = false;
  bool code(bool bit, BitProbability) { return bit; }
};

class IntegerContexts {
 public:
  explicit IntegerContexts(const IntegerStarts& starts) {
    for (size_t i = 0; i < kIntegerContexts && i < starts.size(); ++i)
      models_[i] = IntegerModel(starts[i], kTrust);
  }

  template <typename Port>
  int64_t code(Port& port, int64_t value) {
    const int size = std::bit_width(last_ + before_);
    const size_t context = std::min(static_cast<size_t>((size + 1) / 2), kIntegerContexts - 1);
    value = models_[context].code(port, value);
    before_ = last_;
    const auto magnitude = static_cast<uint64_t>(value);
    last_ = std::min<uint64_t>(value < 0 ? 0 - magnitude : magnitude, 1u << 20);
    return value;
  }

  [[nodiscard]] IntegerStarts starts() const {
    IntegerStarts result;
    for (const IntegerModel& model : models_) result.push_back(model.start());
    return result;
  }

 private:
  std::array<IntegerModel, kIntegerContexts> models_;
  uint64_t last_ = 0;
  uint64_t before_ = 0;
};

}  // namespace

IntegerModel::IntegerModel(std::span<const uint16_t, kStarts> start, int seen) {
  const auto bit = [&](size_t i) { return AdaptiveBit(std::max<uint16_t>(start[i], 1), seen); };
  zero_ = bit(0);
  sign_ = bit(1);
  for (size_t i = 2; i < kStarts; ++i) wider_[i - 2] = bit(i);
}

std::array<uint16_t, IntegerModel::kStarts> IntegerModel::start() const {
  std::array<uint16_t, kStarts> result{};
  result[0] = static_cast<uint16_t>(zero_.one());
  result[1] = static_cast<uint16_t>(sign_.one());
  for (size_t i = 2; i < kStarts; ++i) result[i] = static_cast<uint16_t>(wider_[i - 2].one());
  return result;
}

std::vector<std::byte> encode_integers(std::span<const int32_t> values,
                                       const IntegerStarts& starts) {
  BinaryEncoder encoder;
  IntegerContexts contexts(starts);
  for (const int32_t value : values) contexts.code(encoder, value);
  return with_checksum(encoder.finish());
}

Result<std::vector<int32_t>> decode_integers(std::span<const std::byte> bytes, size_t count,
                                             const IntegerStarts& starts) {
  ENGRAM_ASSIGN_OR_RETURN(const auto body, without_checksum(bytes, "integers"));
  BinaryDecoder decoder(body);
  IntegerContexts contexts(starts);
  std::vector<int32_t> values;
  values.reserve(std::min<size_t>(count, 1 << 20));
  for (size_t i = 0; i < count; ++i) {
    const int64_t value = contexts.code(decoder, 0);
    if (value != static_cast<int32_t>(value))
      return data_loss("integers: found {}, needs 32 bits", value);
    values.push_back(static_cast<int32_t>(value));
  }
  return values;
}

IntegerStarts train_integer_starts(std::span<const int32_t> values) {
  Listener listener;
  IntegerContexts contexts({});
  for (const int32_t value : values) contexts.code(listener, value);
  return contexts.starts();
}

}  // namespace engram::encoders
