// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/binary.h"

#include <bit>
#include <cstring>
#include <string_view>
#include <unordered_set>

namespace engram::idf {

namespace {

static_assert(std::endian::native == std::endian::little, "the binary form is written as it lies");

constexpr std::string_view kMagic = "IDF\x01";
constexpr size_t kAlignment = 8;
constexpr size_t kMaxRank = 16;
/// From this size on, unique keys are checked by hashing.
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

/// Counts what Writer writes: the same walk, so that the two cannot disagree in order.
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

class Writer {
 public:
  explicit Writer(std::byte* out) : begin_(out), out_(out) {}

  void tag(Tag value) { byte(static_cast<uint8_t>(value)); }
  void byte(uint8_t value) { *out_++ = static_cast<std::byte>(value); }
  void varint(uint64_t value) {
    for (; value >= 0x80; value >>= 7) byte(static_cast<uint8_t>(value | 0x80));
    byte(static_cast<uint8_t>(value));
  }
  template <typename T>
  void scalar(T value) {
    bytes(std::as_bytes(std::span(&value, 1)));
  }
  void bytes(std::span<const std::byte> bytes) {
    if (!bytes.empty()) std::memcpy(out_, bytes.data(), bytes.size());
    out_ += bytes.size();
  }
  void align() {
    while (static_cast<size_t>(out_ - begin_) % kAlignment != 0) byte(0);
  }

 private:
  std::byte* begin_;
  std::byte* out_;
};

/// False where `data` nests deeper than `levels` or has an ndarray of too many axes.
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

class Reader {
 public:
  explicit Reader(const Buffer& buffer) : buffer_(buffer), bytes_(buffer.bytes()) {}

  Result<Data> read_all(int max_depth) {
    if (!as_text(bytes_).starts_with(kMagic))
      return data_loss("IDF bytes: needs the header 'IDF' and version 1, found {} other bytes",
                       bytes_.size());
    at_ = kMagic.size();
    ENGRAM_ASSIGN_OR_RETURN(Data data, read(max_depth));
    if (at_ != bytes_.size())
      return data_loss("IDF bytes: {} bytes after the value at offset {}", bytes_.size() - at_,
                       at_);
    return data;
  }

 private:
  [[nodiscard]] size_t left() const { return bytes_.size() - at_; }

  Status broken(std::string_view what) const {
    return data_loss("IDF bytes at offset {}: {}", at_, what);
  }

  Result<Data> read(int levels) {
    if (left() == 0) return broken("the bytes end where a value must start");
    const auto tag = static_cast<Tag>(bytes_[at_++]);
    switch (tag) {
      case Tag::kNone:
        return Data();
      case Tag::kFalse:
        return Data(false);
      case Tag::kTrue:
        return Data(true);
      case Tag::kInt32:
        return read_scalar<int32_t>();
      case Tag::kInt64:
        return read_scalar<int64_t>();
      case Tag::kFloat32:
        return read_scalar<float>();
      case Tag::kFloat64:
        return read_scalar<double>();
      case Tag::kString: {
        ENGRAM_ASSIGN_OR_RETURN(std::string text, read_text());
        return Data(std::move(text));
      }
      case Tag::kNdArray:
        return read_ndarray();
      case Tag::kList:
        return read_list(levels);
      case Tag::kDict:
        return read_dict(levels);
    }
    --at_;
    return broken(fmt::format("unknown tag {}", static_cast<int>(tag)));
  }

  template <typename T>
  Result<Data> read_scalar() {
    if (left() < sizeof(T)) return broken("the bytes end inside a number");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return Data(value);
  }

  Result<uint64_t> read_varint() {
    uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      if (left() == 0) return broken("the bytes end inside a length");
      const auto byte = static_cast<uint64_t>(bytes_[at_++]);
      if (shift == 63 && byte > 1) return broken("a length exceeds 64 bits");
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    return broken("a length exceeds 64 bits");
  }

  /// A number of things of which each takes at least `least` of the bytes that are left.
  Result<size_t> read_count(size_t least) {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t count, read_varint());
    if (count > left() / least)
      return broken(fmt::format("{} elements announced, {} bytes left", count, left()));
    return static_cast<size_t>(count);
  }

  Result<std::string> read_text() {
    ENGRAM_ASSIGN_OR_RETURN(const size_t size, read_count(1));
    std::string text(as_text(bytes_.subspan(at_, size)));
    at_ += size;
    return text;
  }

  Result<Data> read_ndarray() {
    if (left() < 2) return broken("the bytes end inside an ndarray");
    const auto type = element_type_from_code(static_cast<uint8_t>(bytes_[at_]));
    const auto rank = static_cast<size_t>(bytes_[at_ + 1]);
    if (!type || rank > kMaxRank) return broken("an ndarray of unknown type or rank above 16");
    at_ += 2;
    Shape shape(rank);
    for (int64_t& size : shape) {
      ENGRAM_ASSIGN_OR_RETURN(const uint64_t value, read_varint());
      if (value > INT64_MAX) return broken("an axis of an ndarray exceeds 63 bits");
      size = static_cast<int64_t>(value);
    }
    const auto needed = size_bytes(*type, shape);
    const size_t start = aligned(at_);
    if (!needed || start > bytes_.size() || *needed > bytes_.size() - start)
      return broken(fmt::format("an ndarray {} {} exceeds the {} bytes left", to_string(*type),
                                to_string(shape), left()));
    at_ = start + *needed;
    auto array = NdArray::create(*type, shape, buffer_.slice(start, *needed));
    if (!array.ok())
      array = NdArray::create(*type, shape, Buffer::copy(bytes_.subspan(start, *needed)));
    ENGRAM_RETURN_IF_ERROR(array.status());
    return Data(std::move(array).value());
  }

  Result<Data> read_list(int levels) {
    if (levels <= 0) return broken("nests too deep, at most 64 levels are allowed");
    ENGRAM_ASSIGN_OR_RETURN(const size_t count, read_count(1));
    List list;
    list.reserve(std::min(count, kReserveLimit));
    for (size_t i = 0; i < count; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(Data element, read(levels - 1));
      list.push_back(std::move(element));
    }
    return Data(std::move(list));
  }

  Result<Data> read_dict(int levels) {
    if (levels <= 0) return broken("nests too deep, at most 64 levels are allowed");
    ENGRAM_ASSIGN_OR_RETURN(const size_t count, read_count(2));
    Dict dict;
    dict.reserve(std::min(count, kReserveLimit));
    std::unordered_set<std::string> seen;
    for (size_t i = 0; i < count; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(std::string key, read_text());
      const bool is_new =
          count < kHashedDictSize ? dict.find(key) == nullptr : seen.insert(key).second;
      if (!is_new) return broken("a dict has the key '" + key + "' twice");
      ENGRAM_ASSIGN_OR_RETURN(Data value, read(levels - 1));
      dict.append_unique(std::move(key), std::move(value));
    }
    return Data(std::move(dict));
  }

  /// One byte can announce one element of 48: growth beyond this is paid as the bytes arrive.
  static constexpr size_t kReserveLimit = 4096;

  const Buffer& buffer_;
  std::span<const std::byte> bytes_;
  size_t at_ = 0;
};

}  // namespace

size_t encoded_size(const Data& data) {
  Sizer sizer;
  sizer.bytes(as_bytes(kMagic));
  write(data, kMaxDepth + kContainerDepth, sizer);
  return sizer.size();
}

Result<std::vector<std::byte>> encode(const Data& data, int max_depth) {
  std::vector<std::byte> bytes(encoded_size(data));
  Writer writer(bytes.data());
  writer.bytes(as_bytes(kMagic));
  ENGRAM_CHECK(max_depth <= kMaxDepth + kContainerDepth, "{} levels", max_depth);
  if (!write(data, max_depth, writer))
    return invalid_argument("IDF value: nests deeper than {} levels or has an ndarray of rank > {}",
                            max_depth, kMaxRank);
  return bytes;
}

Result<Data> decode(const Buffer& buffer, int max_depth) {
  return Reader(buffer).read_all(max_depth);
}

}  // namespace engram::idf
