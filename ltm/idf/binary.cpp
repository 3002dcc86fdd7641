// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/binary.h"

#include <bit>
#include <cstring>
#include <string_view>
#include <unordered_set>

#include "ltm/core/copy_past_caches.h"
#include "ltm/idf/encode_past_caches.h"

namespace engram::idf {

namespace {

static_assert(std::endian::native == std::endian::little, "the binary form is written as it lies");

constexpr std::string_view kMagic = "IDF\x01";
constexpr size_t kAlignment = 8;
constexpr size_t kMaxRank = 16;
/// From this many keys on, uniqueness is checked with a hash set instead of a search.
constexpr size_t kHashedDictSize = 16;

// The tags are part of the form: never renumber.
enum class Tag : uint8_t {
  kNone = 0,
  kFalse = 1,
  kTrue = 2,
  kInt32 = 3,
  kInt64 = 4,
  kFloat32 = 5,
  kFloat64 = 6,
  kString = 7,
  kNdArray = 8,
  kList = 9,
  kDict = 10,
};

constexpr size_t varint_size(uint64_t value) {
  return value == 0 ? 1 : (static_cast<size_t>(std::bit_width(value)) + 6) / 7;
}

constexpr size_t aligned(size_t offset) {
  return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

/// Computes the size of what Writer writes. Both use the same walk, so that they cannot disagree.
class Sizer {
 public:
  void tag(Tag) { ++size_; }
  void byte(uint8_t) { ++size_; }
  void varint(uint64_t value) { size_ += varint_size(value); }
  template <typename T>
  void scalar(T) {
    size_ += sizeof(T);
  }
  void bytes(std::span<const std::byte> bytes) { size_ += bytes.size(); }
  void align() { size_ = aligned(size_); }
  [[nodiscard]] size_t size() const { return size_; }

 private:
  size_t size_ = 0;
};

/// Appends to reserved memory: filling it with zeros first would cost as much as the copy.
class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}

  void tag(Tag value) { byte(static_cast<uint8_t>(value)); }
  void byte(uint8_t value) { out_.push_back(static_cast<std::byte>(value)); }
  void varint(uint64_t value) {
    for (; value >= 0x80; value >>= 7) byte(static_cast<uint8_t>(value | 0x80));
    byte(static_cast<uint8_t>(value));
  }
  template <typename T>
  void scalar(T value) {
    bytes(std::as_bytes(std::span(&value, 1)));
  }
  void bytes(std::span<const std::byte> bytes) {
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  void align() { out_.resize(aligned(out_.size())); }

 private:
  std::vector<std::byte>& out_;
};

/// Smaller arrays are not worth the wait for memory.
constexpr size_t kPastCaches = size_t{32} << 10;

/// Writes into memory of the caller.
class Filler {
 public:
  explicit Filler(std::span<std::byte> out, bool is_past_caches = false)
      : out_(out), is_past_caches_(is_past_caches) {}

  void tag(Tag value) { byte(static_cast<uint8_t>(value)); }
  void byte(uint8_t value) { scalar(value); }
  void varint(uint64_t value) {
    for (; value >= 0x80; value >>= 7) byte(static_cast<uint8_t>(value | 0x80));
    byte(static_cast<uint8_t>(value));
  }
  template <typename T>
  void scalar(T value) {
    bytes(std::as_bytes(std::span(&value, 1)));
  }
  void bytes(std::span<const std::byte> bytes) {
    ENGRAM_CHECK(bytes.size() <= out_.size() - at_, "{} of {} bytes are taken", at_, out_.size());
    // What was written where it goes stays there.
    if (bytes.data() == out_.data() + at_) {
      at_ += bytes.size();
      return;
    }
    if (is_past_caches_ && bytes.size() >= kPastCaches)
      copy_past_caches(bytes, out_.subspan(at_, bytes.size()));
    else if (!bytes.empty())
      std::memcpy(out_.data() + at_, bytes.data(), bytes.size());
    at_ += bytes.size();
  }
  void align() {
    while (at_ != aligned(at_)) byte(0);
  }
  [[nodiscard]] size_t size() const { return at_; }

 private:
  std::span<std::byte> out_;
  bool is_past_caches_;
  size_t at_ = 0;
};

/// Returns false where `data` nests deeper than `levels` or has an ndarray with too many axes.
template <typename Sink>
bool write(const Data& data, int levels, Sink& sink);

template <typename Sink>
struct ValueWriter {
  Sink& sink;
  int levels;

  bool operator()(None) const { return sink.tag(Tag::kNone), true; }
  bool operator()(bool value) const { return sink.tag(value ? Tag::kTrue : Tag::kFalse), true; }
  bool operator()(int32_t value) const { return scalar(Tag::kInt32, value); }
  bool operator()(int64_t value) const { return scalar(Tag::kInt64, value); }
  bool operator()(float value) const { return scalar(Tag::kFloat32, value); }
  bool operator()(double value) const { return scalar(Tag::kFloat64, value); }
  bool operator()(const std::string& value) const {
    sink.tag(Tag::kString);
    return text(value), true;
  }
  bool operator()(const NdArray& array) const {
    sink.tag(Tag::kNdArray);
    sink.byte(static_cast<uint8_t>(array.type()));
    sink.byte(static_cast<uint8_t>(array.rank()));
    for (const int64_t size : array.shape()) sink.varint(static_cast<uint64_t>(size));
    sink.align();
    sink.bytes(array.bytes());
    return array.rank() <= kMaxRank;
  }
  bool operator()(const List& list) const {
    if (levels <= 0) return false;
    sink.tag(Tag::kList);
    sink.varint(list.size());
    for (const Data& element : list)
      if (!write(element, levels - 1, sink)) return false;
    return true;
  }
  bool operator()(const Dict& dict) const {
    if (levels <= 0) return false;
    sink.tag(Tag::kDict);
    sink.varint(dict.size());
    for (const DictEntry& entry : dict) {
      text(entry.key);
      if (!write(entry.value, levels - 1, sink)) return false;
    }
    return true;
  }

 private:
  template <typename T>
  bool scalar(Tag tag, T value) const {
    sink.tag(tag);
    sink.scalar(value);
    return true;
  }
  void text(const std::string& value) const {
    sink.varint(value.size());
    sink.bytes(as_bytes(value));
  }
};

template <typename Sink>
bool write(const Data& data, int levels, Sink& sink) {
  return std::visit(ValueWriter<Sink>{sink, levels}, data.value());
}

/// Reads into values of the caller. The first error is kept and ends the reading: a Result per node
/// cost more than the reading itself (207 ns per moderate object instead of 98 ns).
class Reader {
 public:
  explicit Reader(const Buffer& buffer) : buffer_(buffer), bytes_(buffer.bytes()) {}

  Result<Data> read_all(int max_depth) {
    if (!as_text(bytes_).starts_with(kMagic))
      return data_loss("IDF bytes: needs the header 'IDF' and version 1, found {} other bytes",
                       bytes_.size());
    at_ = kMagic.size();
    Data data;
    if (!read(data, max_depth)) return error_;
    if (at_ != bytes_.size())
      return data_loss("IDF bytes: {} bytes after the value at offset {}", bytes_.size() - at_,
                       at_);
    return data;
  }

 private:
  [[nodiscard]] size_t left() const { return bytes_.size() - at_; }

  [[gnu::cold]] bool fail(std::string_view what) {
    error_ = data_loss("IDF bytes at offset {}: {}", at_, what);
    return false;
  }

  bool read(Data& out, int levels) {
    if (left() == 0) return fail("the bytes end where a value must start");
    const auto tag = static_cast<Tag>(bytes_[at_++]);
    switch (tag) {
      case Tag::kNone:
        return true;
      case Tag::kFalse:
        return out = Data(false), true;
      case Tag::kTrue:
        return out = Data(true), true;
      case Tag::kInt32:
        return read_scalar<int32_t>(out);
      case Tag::kInt64:
        return read_scalar<int64_t>(out);
      case Tag::kFloat32:
        return read_scalar<float>(out);
      case Tag::kFloat64:
        return read_scalar<double>(out);
      case Tag::kString:
        return read_text(out.value().emplace<std::string>());
      case Tag::kNdArray:
        return read_ndarray(out);
      case Tag::kList:
        return read_list(out.value().emplace<List>(), levels);
      case Tag::kDict:
        return read_dict(out.value().emplace<Dict>(), levels);
    }
    --at_;
    return fail(fmt::format("unknown tag {}", static_cast<int>(tag)));
  }

  template <typename T>
  bool read_scalar(Data& out) {
    if (left() < sizeof(T)) return fail("the bytes end inside a number");
    std::memcpy(&out.value().emplace<T>(), bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return true;
  }

  bool read_varint(uint64_t& value) {
    value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      if (left() == 0) return fail("the bytes end inside a length");
      const auto byte = static_cast<uint64_t>(bytes_[at_++]);
      if (shift == 63 && byte > 1) return fail("a length exceeds 64 bits");
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return true;
    }
    return fail("a length exceeds 64 bits");
  }

  /// Reads a count of items that take at least `min` of the remaining bytes each.
  bool read_count(size_t& count, size_t min) {
    uint64_t announced = 0;
    if (!read_varint(announced)) return false;
    if (announced > left() / min)
      return fail(fmt::format("{} elements announced, {} bytes left", announced, left()));
    count = announced;
    return true;
  }

  bool read_text(std::string& out) {
    size_t size = 0;
    if (!read_count(size, 1)) return false;
    out.assign(as_text(bytes_.subspan(at_, size)));
    at_ += size;
    return true;
  }

  bool read_ndarray(Data& out) {
    if (left() < 2) return fail("the bytes end inside an ndarray");
    const auto type = element_type_from_code(static_cast<uint8_t>(bytes_[at_]));
    const auto rank = static_cast<size_t>(bytes_[at_ + 1]);
    if (!type || rank > kMaxRank) return fail("an ndarray of unknown type or rank above 16");
    at_ += 2;
    Shape shape(rank);
    for (int64_t& size : shape) {
      uint64_t value = 0;
      if (!read_varint(value)) return false;
      if (value > INT64_MAX) return fail("an axis of an ndarray exceeds 63 bits");
      size = static_cast<int64_t>(value);
    }
    const auto needed = size_bytes(*type, shape);
    const size_t start = aligned(at_);
    if (!needed || start > bytes_.size() || *needed > bytes_.size() - start)
      return fail(fmt::format("an ndarray {} {} exceeds the {} bytes left", to_string(*type),
                              to_string(shape), left()));
    at_ = start + *needed;
    auto array = NdArray::create(*type, shape, buffer_.slice(start, *needed));
    if (!array.ok())
      array = NdArray::create(*type, shape, Buffer::copy(bytes_.subspan(start, *needed)));
    if (!array.ok()) return fail(array.status().message());
    out = Data(std::move(array).value());
    return true;
  }

  bool read_list(List& out, int levels) {
    if (levels <= 0) return fail("nests too deep, at most 64 levels are allowed");
    size_t count = 0;
    if (!read_count(count, 1)) return false;
    out.reserve(std::min(count, kReserveLimit));
    for (size_t i = 0; i < count; ++i)
      if (!read(out.emplace_back(), levels - 1)) return false;
    return true;
  }

  bool read_dict(Dict& out, int levels) {
    if (levels <= 0) return fail("nests too deep, at most 64 levels are allowed");
    size_t count = 0;
    if (!read_count(count, 2)) return false;
    out.reserve(std::min(count, kReserveLimit));
    std::unordered_set<std::string> seen;
    for (size_t i = 0; i < count; ++i) {
      std::string key;
      if (!read_text(key)) return false;
      const bool is_new =
          count < kHashedDictSize ? out.find(key) == nullptr : seen.insert(key).second;
      if (!is_new) return fail("a dict has the key '" + key + "' twice");
      if (!read(out.append_unique(std::move(key), Data()), levels - 1)) return false;
    }
    return true;
  }

  /// One byte can announce one element of 48: memory beyond this count is allocated as the bytes
  /// come.
  static constexpr size_t kReserveLimit = 4096;

  const Buffer& buffer_;
  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  Status error_;
};

}  // namespace

size_t encoded_size(const Data& data) {
  Sizer sizer;
  sizer.bytes(as_bytes(kMagic));
  write(data, kMaxDepth + kContainerDepth, sizer);
  return sizer.size();
}

Result<std::vector<std::byte>> encode(const Data& data, int max_depth) {
  std::vector<std::byte> bytes;
  bytes.reserve(encoded_size(data));
  Writer writer(bytes);
  writer.bytes(as_bytes(kMagic));
  ENGRAM_CHECK(max_depth <= kMaxDepth + kContainerDepth, "{} levels", max_depth);
  if (!write(data, max_depth, writer))
    return invalid_argument("IDF value: nests deeper than {} levels or has an ndarray of rank > {}",
                            max_depth, kMaxRank);
  return bytes;
}

namespace {

Status fill(const Data& data, std::span<std::byte> out, int max_depth, Filler filler) {
  ENGRAM_CHECK(max_depth <= kMaxDepth + kContainerDepth, "{} levels", max_depth);
  filler.bytes(as_bytes(kMagic));
  if (!write(data, max_depth, filler))
    return invalid_argument("IDF value: nests deeper than {} levels or has an ndarray of rank > {}",
                            max_depth, kMaxRank);
  ENGRAM_CHECK(filler.size() == out.size(), "{} of {} bytes", filler.size(), out.size());
  return {};
}

}  // namespace

Status encode_into(const Data& data, std::span<std::byte> out, int max_depth) {
  return fill(data, out, max_depth, Filler(out));
}

Status encode_past_caches(const Data& data, std::span<std::byte> out, int max_depth) {
  return fill(data, out, max_depth, Filler(out, true));
}

Result<Data> decode(const Buffer& buffer, int max_depth) {
  return Reader(buffer).read_all(max_depth);
}

}  // namespace engram::idf
