// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/column_codec.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>

#include "ltm/codec/shuffle.h"
#include "ltm/codec/zstd.h"
#include "ltm/idf/element_visit.h"

namespace engram::ltm {

namespace {

using Bytes = std::vector<std::byte>;

constexpr std::byte kVersion{1};
constexpr size_t kHeaderBytes = 4;
constexpr int kTrialLevel = 3;
constexpr int kFinalLevel = 9;
constexpr size_t kTrialBytes = 64 << 10;
constexpr uint8_t kNoDecimals = 255;
constexpr uint8_t kMaxDecimals = 9;
/// Larger integers are not exact in a double.
constexpr double kMaxExact = 9007199254740992.0;

constexpr std::array<double, kMaxDecimals + 1> kPowers{1,   1e1, 1e2, 1e3, 1e4,
                                                       1e5, 1e6, 1e7, 1e8, 1e9};

/// The unsigned integer of the same size. Unsigned differences are always defined, even if they
/// overflow.
template <size_t kSize>
using Word = std::conditional_t<
    kSize == 1, uint8_t,
    std::conditional_t<kSize == 2, uint16_t, std::conditional_t<kSize == 4, uint32_t, uint64_t>>>;

template <typename W>
std::vector<W> words_of(std::span<const std::byte> bytes) {
  std::vector<W> words(bytes.size() / sizeof(W));
  if (!words.empty()) std::memcpy(words.data(), bytes.data(), words.size() * sizeof(W));
  return words;
}

template <typename W>
void delta(std::vector<W>& words) {
  W before = 0;
  for (W& word : words) {
    const W here = word;
    word = static_cast<W>(here - before);
    before = here;
  }
}

template <typename W>
void sum(std::vector<W>& words) {
  W total = 0;
  for (W& word : words) word = total = static_cast<W>(total + word);
}

/// Maps 0, -1, 1, -2, ... to 0, 1, 2, 3, ..., so that small numbers of either sign have zero high
/// bytes.
template <typename W>
void fold(std::vector<W>& words) {
  for (W& word : words) {
    const auto sign = static_cast<W>(0 - (word >> (8 * sizeof(W) - 1)));
    word = static_cast<W>(static_cast<W>(word << 1) ^ sign);
  }
}

template <typename W>
void unfold(std::vector<W>& words) {
  for (W& word : words) word = static_cast<W>((word >> 1) ^ static_cast<W>(0 - (word & 1)));
}

template <typename W>
void apply(ColumnTransform transform, std::vector<W>& words) {
  switch (transform) {
    case ColumnTransform::kNone:
      return;
    case ColumnTransform::kXor:
      for (size_t i = words.size(); i > 1; --i)
        words[i - 1] = static_cast<W>(words[i - 1] ^ words[i - 2]);
      return;
    case ColumnTransform::kDeltaDelta:
      delta(words);
      [[fallthrough]];
    case ColumnTransform::kDelta:
      delta(words);
      fold(words);
  }
}

template <typename W>
void undo(ColumnTransform transform, std::vector<W>& words) {
  switch (transform) {
    case ColumnTransform::kNone:
      return;
    case ColumnTransform::kXor:
      for (size_t i = 1; i < words.size(); ++i) words[i] = static_cast<W>(words[i] ^ words[i - 1]);
      return;
    case ColumnTransform::kDelta:
      unfold(words);
      sum(words);
      return;
    case ColumnTransform::kDeltaDelta:
      unfold(words);
      sum(words);
      sum(words);
  }
}

Bytes shuffled(ColumnShuffle shuffle, size_t size, std::span<const std::byte> bytes) {
  Bytes out(bytes.size());
  if (shuffle == ColumnShuffle::kBytes) shuffle_bytes(bytes, size, out);
  if (shuffle == ColumnShuffle::kBits) shuffle_bits(bytes, size, out);
  if (shuffle == ColumnShuffle::kNone) out.assign(bytes.begin(), bytes.end());
  return out;
}

Bytes unshuffled(ColumnShuffle shuffle, size_t size, Bytes bytes) {
  Bytes out(bytes.size());
  if (shuffle == ColumnShuffle::kNone) return bytes;
  if (shuffle == ColumnShuffle::kBytes) unshuffle_bytes(bytes, size, out);
  if (shuffle == ColumnShuffle::kBits) unshuffle_bits(bytes, size, out);
  return out;
}

/// The float as an integer with this many decimal digits, or nullopt if it is not exactly
/// representable.
template <typename T>
std::optional<int64_t> as_decimal(T value, uint8_t decimals) {
  const double scaled = std::nearbyint(static_cast<double>(value) * kPowers[decimals]);
  if (!(std::abs(scaled) < kMaxExact)) return std::nullopt;
  const auto whole = static_cast<int64_t>(scaled);
  const T back = static_cast<T>(static_cast<double>(whole) / kPowers[decimals]);
  // Compare bits, because minus zero equals zero but is another number.
  if (std::bit_cast<Word<sizeof(T)>>(back) != std::bit_cast<Word<sizeof(T)>>(value))
    return std::nullopt;
  if (whole != static_cast<std::make_signed_t<Word<sizeof(T)>>>(whole)) return std::nullopt;
  return whole;
}

/// The column as integers, with the fewest decimal digits that represent all of it. On tables that
/// were parsed from text this is most of the codec's gain.
template <typename T>
std::optional<std::pair<uint8_t, std::vector<Word<sizeof(T)>>>> as_decimals(
    const std::vector<T>& values) {
  uint8_t decimals = 0;
  std::vector<Word<sizeof(T)>> words;
  for (size_t i = 0; i < values.size();) {
    const auto whole = as_decimal(values[i], decimals);
    if (whole) {
      words.push_back(static_cast<Word<sizeof(T)>>(*whole));
      ++i;
      continue;
    }
    if (++decimals > kMaxDecimals) return std::nullopt;
    words.clear();
    i = 0;
  }
  return std::pair{decimals, std::move(words)};
}

template <typename T, typename W>
Bytes from_decimals(const std::vector<W>& words, uint8_t decimals) {
  std::vector<T> values;
  values.reserve(words.size());
  for (const W word : words)
    values.push_back(static_cast<T>(static_cast<double>(static_cast<std::make_signed_t<W>>(word)) /
                                    kPowers[decimals]));
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

template <typename W>
Bytes compress(const ColumnScheme& scheme, std::vector<W> words, int level) {
  apply(scheme.transform, words);
  return compress_zstd(shuffled(scheme.shuffle, sizeof(W), std::as_bytes(std::span(words))), level);
}

/// The whole of a short column; start, middle and end of a long one. Trying every scheme on all of
/// a long column would cost about 12 times as much as compressing it once.
template <typename W>
std::vector<W> trial_of(const std::vector<W>& words) {
  const size_t max = kTrialBytes / sizeof(W);
  if (words.size() <= max) return words;
  std::vector<W> trial;
  for (const size_t start : {size_t{0}, (words.size() - max / 3) / 2, words.size() - max / 3})
    trial.insert(trial.end(), words.begin() + static_cast<ptrdiff_t>(start),
                 words.begin() + static_cast<ptrdiff_t>(start + max / 3));
  return trial;
}

/// Tries all schemes on `words` and stores the best one in `scheme` if it is smaller than `min`.
template <typename W>
void try_all(const std::vector<W>& words, uint8_t decimals, ColumnScheme& scheme, size_t& min) {
  const std::vector<W> trial = trial_of(words);
  for (const auto transform : {ColumnTransform::kNone, ColumnTransform::kDelta,
                               ColumnTransform::kXor, ColumnTransform::kDeltaDelta})
    for (const auto shuffle : {ColumnShuffle::kNone, ColumnShuffle::kBytes, ColumnShuffle::kBits}) {
      const ColumnScheme tried{transform, shuffle, decimals};
      const size_t size = compress(tried, trial, kTrialLevel).size();
      if (size >= min) continue;
      min = size;
      scheme = tried;
    }
}

template <typename T>
Bytes compress_best(std::span<const std::byte> elements) {
  using W = Word<sizeof(T)>;
  ColumnScheme scheme;
  size_t min = SIZE_MAX;
  std::vector<W> words = words_of<W>(elements);
  if constexpr (std::is_floating_point_v<T>) {
    if (auto decimals = as_decimals(words_of<T>(elements)); decimals && !words.empty()) {
      try_all(decimals->second, decimals->first, scheme, min);
      // Decimals are tried first, so the plain floats replace them only if they are smaller. An
      // unchanged scheme means that the decimals won.
      const ColumnScheme best = scheme;
      try_all(words, kNoDecimals, scheme, min);
      if (scheme == best) words = std::move(decimals->second);
    } else {
      try_all(words, kNoDecimals, scheme, min);
    }
  } else {
    try_all(words, kNoDecimals, scheme, min);
  }
  Bytes out{kVersion, static_cast<std::byte>(scheme.transform),
            static_cast<std::byte>(scheme.shuffle), static_cast<std::byte>(scheme.decimals)};
  const Bytes frame = compress(scheme, std::move(words), kFinalLevel);
  out.insert(out.end(), frame.begin(), frame.end());
  return out;
}

template <typename T>
Result<Bytes> decompress(const ColumnScheme& scheme, Bytes stored) {
  using W = Word<sizeof(T)>;
  auto words = words_of<W>(unshuffled(scheme.shuffle, sizeof(W), std::move(stored)));
  undo(scheme.transform, words);
  if constexpr (std::is_floating_point_v<T>)
    if (scheme.decimals != kNoDecimals) return from_decimals<T>(words, scheme.decimals);
  if (scheme.decimals != kNoDecimals) return data_loss("column of integers with decimals");
  const auto bytes = std::as_bytes(std::span(words));
  return Bytes(bytes.begin(), bytes.end());
}

}  // namespace

std::string to_string(const ColumnScheme& scheme) {
  static constexpr std::array<const char*, 4> kTransforms{"plain", "delta", "xor",
                                                          "delta of delta"};
  static constexpr std::array<const char*, 3> kShuffles{"", ", bytes", ", bits"};
  std::string text = kTransforms[static_cast<size_t>(scheme.transform)];
  text += kShuffles[static_cast<size_t>(scheme.shuffle)];
  if (scheme.decimals != kNoDecimals) text += fmt::format(", {} decimals", scheme.decimals);
  return text;
}

std::vector<std::byte> compress_column(idf::ElementType type, std::span<const std::byte> elements) {
  ENGRAM_CHECK(elements.size() % idf::size_bytes(type) == 0, "{} bytes of {}", elements.size(),
               idf::to_string(type));
  return idf::visit_element_type(type, [&]<typename T>(T) { return compress_best<T>(elements); });
}

Result<ColumnScheme> column_scheme(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes || bytes[0] != kVersion)
    return data_loss("{} bytes are no column", bytes.size());
  const auto transform = std::to_integer<uint8_t>(bytes[1]);
  const auto shuffle = std::to_integer<uint8_t>(bytes[2]);
  const auto decimals = std::to_integer<uint8_t>(bytes[3]);
  if (transform > 3 || shuffle > 2 || (decimals > kMaxDecimals && decimals != kNoDecimals))
    return data_loss("column of unknown scheme {}, {}, {}", transform, shuffle, decimals);
  return ColumnScheme{static_cast<ColumnTransform>(transform), static_cast<ColumnShuffle>(shuffle),
                      decimals};
}

Result<std::vector<std::byte>> decompress_column(std::span<const std::byte> bytes,
                                                 idf::ElementType type, size_t count) {
  ENGRAM_ASSIGN_OR_RETURN(const ColumnScheme scheme, column_scheme(bytes));
  const size_t width = idf::size_bytes(type);
  if (count > SIZE_MAX / width) return data_loss("column of {} {}", count, idf::to_string(type));
  ENGRAM_ASSIGN_OR_RETURN(auto stored, decompress_zstd(bytes.subspan(kHeaderBytes), count * width));
  if (stored.size() != count * width)
    return data_loss("column: found {} bytes, {} {} need {}", stored.size(), count,
                     idf::to_string(type), count * width);
  return idf::visit_element_type(
      type, [&]<typename T>(T) { return decompress<T>(scheme, std::move(stored)); });
}

}  // namespace engram::ltm
