// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/image_members.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace engram::ltm {

namespace {

using idf::ElementType;

constexpr int64_t kMaxChannels = 4;
/// Smaller arrays of two axes are matrices and tables. Unit: elements.
constexpr int64_t kMinMatrixSide = 32;
/// Arrays of floats with so many columns are point clouds (ltm/codec/packed_value.h).
constexpr int64_t kMaxCloudFields = 16;

bool is_side(int64_t size) {
  return size >= kMinImageSide && size <= std::numeric_limits<int32_t>::max();
}

bool is_channels(int64_t size) {
  return size >= 1 && size <= kMaxChannels;
}

/// The layout of the last `rank` axes of a shape, which are one image.
std::optional<ImageLayout> layout_of_one(const idf::Shape& shape, size_t rank) {
  const size_t at = shape.size() - rank;
  ImageLayout layout;
  if (rank == 2 && is_side(shape[at]) && is_side(shape[at + 1])) {
    layout.height = shape[at];
    layout.width = shape[at + 1];
    layout.row_step = layout.width;
    return layout;
  }
  if (rank != 3) return std::nullopt;
  if (is_side(shape[at]) && is_side(shape[at + 1]) && is_channels(shape[at + 2])) {
    layout.height = shape[at];
    layout.width = shape[at + 1];
    layout.channels = shape[at + 2];
    layout.column_step = layout.channels;
    layout.row_step = layout.width * layout.channels;
    return layout;
  }
  if (is_channels(shape[at]) && is_side(shape[at + 1]) && is_side(shape[at + 2])) {
    layout.channels = shape[at];
    layout.height = shape[at + 1];
    layout.width = shape[at + 2];
    layout.row_step = layout.width;
    layout.channel_step = layout.width * layout.height;
    return layout;
  }
  return std::nullopt;
}

/// Whether bytes begin as files of images or videos do.
bool begins_encoded(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes.first(std::min<size_t>(bytes.size(), 16)));
  if (text.size() < 16) return false;
  using namespace std::string_view_literals;
  static constexpr std::array kBegins{"\xFF\xD8\xFF"sv,
                                      "\x89PNG\r\n\x1A\n"sv,
                                      "GIF87a"sv,
                                      "GIF89a"sv,
                                      "II*\0"sv,
                                      "MM\0*"sv,
                                      "\0\0\0\x0CjP  "sv,
                                      "\xFF\x4F\xFF\x51"sv,
                                      "\0\0\0\1\x67"sv,
                                      "\0\0\0\1\x27"sv,
                                      "\0\0\0\1\x40\1"sv,
                                      "\0\0\1\xB3"sv,
                                      "\x1A\x45\xDF\xA3"sv,
                                      "\xFF\x0A"sv,
                                      "P6\n"sv,
                                      "P5\n"sv};
  if (std::ranges::any_of(kBegins, [&](std::string_view each) { return text.starts_with(each); }))
    return true;
  // The same as text, by base64.
  for (const std::string_view each : {"data:image/"sv, "data:video/"sv, "/9j/"sv, "iVBORw0KGgo"sv})
    if (text.starts_with(each)) return true;
  const std::string_view kind = text.substr(8, 4);
  if (text.starts_with("RIFF") && (kind == "WEBP" || kind == "AVI ")) return true;
  if (text.substr(4, 4) == "ftyp") return true;  // HEIF, AVIF, MP4
  // A bitmap tells its size.
  uint32_t size = 0;
  std::memcpy(&size, text.data() + 2, sizeof(size));
  return text.starts_with("BM") && size == bytes.size();
}

class Finder {
 public:
  void visit(idf::Data& value, const std::string& path) {
    if (auto* array = value.get_if<idf::NdArray>()) {
      add(*array, path);
    } else if (const auto* text = value.get_if<std::string>()) {
      note_encoded(std::as_bytes(std::span(text->data(), text->size())), path);
    } else if (auto* list = value.get_if<idf::List>()) {
      for (size_t i = 0; i < list->size(); ++i)
        visit((*list)[i], idf::join_path(path, std::to_string(i)));
    } else if (auto* dict = value.get_if<idf::Dict>()) {
      // A dict gives values to be changed by their keys alone, and finding each key takes linear
      // time; the dict itself may be changed here.
      for (const idf::DictEntry& entry : *dict)
        visit(const_cast<idf::Data&>(entry.value), idf::join_path(path, entry.key));
    }
  }

  FoundImages found;

 private:
  void add(idf::NdArray& array, const std::string& path) {
    if (const auto layout = image_layout_of(array.type(), array.shape()))
      found.members.push_back({path, &array, *layout});
    else if (idf::size_bytes(array.type()) == 1)
      note_encoded(array.bytes(), path);
  }

  void note_encoded(std::span<const std::byte> bytes, const std::string& path) {
    if (!found.encoded && begins_encoded(bytes)) found.encoded = path;
  }
};

/// Calls `use` with a null pointer of the type of the elements.
template <typename Use>
void with_element(ElementType type, const Use& use) {
  switch (type) {
    case ElementType::kInt8:
      return use(static_cast<int8_t*>(nullptr));
    case ElementType::kInt16:
      return use(static_cast<int16_t*>(nullptr));
    case ElementType::kInt32:
      return use(static_cast<int32_t*>(nullptr));
    case ElementType::kInt64:
      return use(static_cast<int64_t*>(nullptr));
    case ElementType::kUInt8:
      return use(static_cast<uint8_t*>(nullptr));
    case ElementType::kUInt16:
      return use(static_cast<uint16_t*>(nullptr));
    case ElementType::kUInt32:
      return use(static_cast<uint32_t*>(nullptr));
    case ElementType::kUInt64:
      return use(static_cast<uint64_t*>(nullptr));
    case ElementType::kFloat32:
      return use(static_cast<float*>(nullptr));
    case ElementType::kFloat64:
      return use(static_cast<double*>(nullptr));
  }
}

/// The elements of an image in the order of GreyOrRgb, `shown` channels of them.
template <typename T, typename Visit>
void for_each_element(const T* first, const ImageLayout& layout, int64_t shown,
                      const Visit& visit) {
  for (int64_t y = 0; y < layout.height; ++y)
    for (int64_t x = 0; x < layout.width; ++x)
      for (int64_t c = 0; c < shown; ++c)
        visit(first[y * layout.row_step + x * layout.column_step + c * layout.channel_step]);
}

template <typename T>
void stretch(const T* first, const ImageLayout& layout, GreyOrRgb& out) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for_each_element(first, layout, out.channels, [&](T value) {
    const auto number = static_cast<double>(value);
    if (!std::isfinite(number)) return;
    low = std::min(low, number);
    high = std::max(high, number);
  });
  // Halves, because the difference of two doubles may be beyond them.
  const double range = high / 2 - low / 2;
  for_each_element(first, layout, out.channels, [&](T value) {
    const auto number = static_cast<double>(value);
    const bool is_shown = std::isfinite(number) && range > 0;
    out.pixels.push_back(
        is_shown ? static_cast<uint8_t>(255 * std::clamp((number / 2 - low / 2) / range, 0.0, 1.0))
                 : 0);
  });
}

/// The mean of those that are finite; zero where none is.
template <typename T>
class Mean {
 public:
  /// The sum of 2^31 elements of 32 bits is within a double; that of large doubles is within a
  /// long double.
  using Sum = std::conditional_t<(sizeof(T) <= 4), double, long double>;

  void add(T value) {
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(value)) return;
    ++count_;
    sum_ += static_cast<Sum>(value);
  }

  [[nodiscard]] T value() const {
    if (count_ == 0) return T{};
    // Rounding may lead beyond the largest element.
    const auto mean = static_cast<long double>(sum_ / static_cast<Sum>(count_));
    return static_cast<T>(std::clamp(mean,
                                     static_cast<long double>(std::numeric_limits<T>::lowest()),
                                     static_cast<long double>(std::numeric_limits<T>::max())));
  }

 private:
  Sum sum_ = 0;
  int64_t count_ = 0;
};

/// Sets a rectangle of one channel to what `value` makes of its elements.
template <typename T>
void set_mean(T* channel, const ImageLayout& layout, const ImagePart& part) {
  Mean<T> mean;
  for (int64_t y = part.top; y < part.bottom; ++y)
    for (int64_t x = part.left; x < part.right; ++x)
      mean.add(channel[y * layout.row_step + x * layout.column_step]);
  const T value = mean.value();
  for (int64_t y = part.top; y < part.bottom; ++y)
    for (int64_t x = part.left; x < part.right; ++x)
      channel[y * layout.row_step + x * layout.column_step] = value;
}

template <typename T>
void pixelate_part(T* channel, const ImageLayout& layout, const ImagePart& part) {
  const int64_t side = std::max(part.right - part.left, part.bottom - part.top);
  const int64_t block = std::max(kMinBlock, (side + kMaxBlocks - 1) / kMaxBlocks);
  for (int64_t top = part.top; top < part.bottom; top += block)
    for (int64_t left = part.left; left < part.right; left += block)
      set_mean(channel, layout,
               {part.image, left, top, std::min(left + block, part.right),
                std::min(top + block, part.bottom)});
}

template <typename T>
void fill_part(T* channel, const ImageLayout& layout, const ImagePart& part) {
  for (int64_t y = part.top; y < part.bottom; ++y)
    for (int64_t x = part.left; x < part.right; ++x)
      channel[y * layout.row_step + x * layout.column_step] = T{};
}

/// Changes each channel of each part in a copy of the array, because others share its buffer.
template <typename Change>
void change_copy(idf::NdArray& array, const ImageLayout& layout,
                 const std::vector<ImagePart>& parts, const Change& change) {
  with_element(array.type(), [&]<typename T>(T*) {
    const auto given = array.values<T>();
    std::vector<T> values(given.begin(), given.end());
    for (const ImagePart& part : parts)
      for (int64_t c = 0; c < layout.channels; ++c)
        change(values.data() + part.image * layout.image_step + c * layout.channel_step, part);
    array = idf::NdArray::take(array.shape(), std::move(values));
  });
}

}  // namespace

std::optional<ImageLayout> image_layout_of(ElementType type, const idf::Shape& shape) {
  const bool is_float = type == ElementType::kFloat32 || type == ElementType::kFloat64;
  if (shape.size() == 2 && is_float && shape[1] <= kMaxCloudFields) return std::nullopt;
  if (shape.size() == 2 && (shape[0] < kMinMatrixSide || shape[1] < kMinMatrixSide))
    return std::nullopt;
  if (auto layout = layout_of_one(shape, std::min<size_t>(shape.size(), 3))) {
    if (shape.size() <= 3) return layout;
    if (shape.size() > 4) return std::nullopt;
    layout->images = shape[0];
    layout->image_step = layout->height * layout->width * layout->channels;
    return layout;
  }
  if (shape.size() != 3 || is_float) return std::nullopt;
  // A list of images without an axis for channels, and not the features of a network.
  auto layout = layout_of_one(shape, 2);
  if (!layout) return std::nullopt;
  layout->images = shape[0];
  layout->image_step = layout->height * layout->width;
  return layout;
}

FoundImages find_images(idf::Data& value) {
  Finder finder;
  finder.visit(value, "");
  return std::move(finder.found);
}

GreyOrRgb pixels_of(const idf::NdArray& array, const ImageLayout& layout, int64_t index) {
  GreyOrRgb out;
  out.channels = layout.channels >= 3 ? 3 : 1;
  out.pixels.reserve(static_cast<size_t>(layout.width * layout.height * out.channels));
  with_element(array.type(), [&]<typename T>(T*) {
    const T* const first = array.values<T>().data() + index * layout.image_step;
    const bool is_dense = layout.channels == out.channels && layout.column_step == out.channels;
    if constexpr (!std::is_same_v<T, uint8_t>)
      stretch(first, layout, out);
    else if (is_dense)
      out.pixels.assign(first, first + layout.height * layout.row_step);
    else
      for_each_element(first, layout, out.channels,
                       [&out](uint8_t value) { out.pixels.push_back(value); });
  });
  return out;
}

void pixelate(idf::NdArray& array, const ImageLayout& layout, const std::vector<ImagePart>& parts) {
  change_copy(array, layout, parts, [&]<typename T>(T* channel, const ImagePart& part) {
    pixelate_part(channel, layout, part);
  });
}

void fill(idf::NdArray& array, const ImageLayout& layout, const std::vector<ImagePart>& parts) {
  change_copy(array, layout, parts, [&]<typename T>(T* channel, const ImagePart& part) {
    fill_part(channel, layout, part);
  });
}

}  // namespace engram::ltm
