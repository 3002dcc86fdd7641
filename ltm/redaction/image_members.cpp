// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/image_members.h"

#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ltm/core/printable.h"
#include "ltm/idf/element_visit.h"
#include "ltm/idf/value_walk.h"
#include "ltm/redaction/encoded_image.h"

namespace engram::ltm {

namespace {

using idf::ElementType;

constexpr int64_t kMaxPlanes = 4;
/// More are a side. Less than kMinImageSide, so that it is one or the other.
constexpr int64_t kMaxChannels = kMinImageSide - 1;
/// Smaller arrays of two axes are matrices, tables and point clouds. Unit: elements.
constexpr int64_t kMinMatrixSide = 32;

bool is_side(int64_t size) {
  return size >= kMinImageSide && size <= std::numeric_limits<int32_t>::max();
}

bool is_within(int64_t size, int64_t max) {
  return size >= 1 && size <= max;
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
  if (is_side(shape[at]) && is_side(shape[at + 1]) && is_within(shape[at + 2], kMaxChannels)) {
    layout.height = shape[at];
    layout.width = shape[at + 1];
    layout.channels = shape[at + 2];
    layout.column_step = layout.channels;
    layout.row_step = layout.width * layout.channels;
    return layout;
  }
  if (is_within(shape[at], kMaxPlanes) && is_side(shape[at + 1]) && is_side(shape[at + 2])) {
    layout.channels = shape[at];
    layout.height = shape[at + 1];
    layout.width = shape[at + 2];
    layout.row_step = layout.width;
    layout.channel_step = layout.width * layout.height;
    return layout;
  }
  return std::nullopt;
}

/// Whether an array that has no layout of images may yet show something: that of a camera in rows
/// of planes, or anything that nobody thought of.
bool may_show_images(ElementType type, const idf::Shape& shape) {
  const bool is_of_camera = idf::size_bytes(type) <= 2;
  return is_of_camera && shape.size() > 2 &&
         std::ranges::count_if(shape, [](int64_t size) { return size >= kMinMatrixSide; }) > 1;
}

class ImageFinder {
 public:
  void visit(const std::string& path, idf::Data& value) {
    if (auto* array = value.get_if<idf::NdArray>()) {
      add(*array, path);
    } else if (const auto* text = value.get_if<std::string>()) {
      add_bytes(std::as_bytes(std::span(text->data(), text->size())), path);
    } else if (const auto* dict = value.get_if<idf::Dict>()) {
      if (const auto bytes = image_bytes_of(*dict))
        note(idf::join_path(path, *bytes), "is an image or video as bytes");
    }
  }

  FoundImages found;

 private:
  void add(idf::NdArray& array, const std::string& path) {
    if (const auto layout = image_layout_of(array.type(), array.shape()))
      found.members.push_back({path, &array, *layout});
    else if (may_show_images(array.type(), array.shape()))
      note(path, fmt::format("of shape [{}] may be images", fmt::join(array.shape(), ", ")));
    else if (idf::size_bytes(array.type()) == 1)
      add_bytes(array.bytes(), path);
  }

  void add_bytes(std::span<const std::byte> bytes, const std::string& path) {
    if (begins_as_image_or_video(bytes)) note(path, "is a file of an image or video");
  }

  void note(const std::string& path, std::string_view is) {
    if (found.unreadable.empty())
      found.unreadable = fmt::format("'{}' {}, in which no detector looks", printable(path), is);
  }
};

/// The channels of an image that are shown in one look.
struct ShownChannels {
  int64_t first = 0;
  int64_t count = 1;
};

ShownChannels shown_in(const ImageLayout& layout, int64_t look) {
  if (layout.channels < 3) return {look, 1};
  return look == 0 ? ShownChannels{0, 3} : ShownChannels{look + 2, 1};
}

/// The elements of an image in the order of GreyOrRgb.
template <typename T, typename Visit>
void for_each_element(const T* image, const ImageLayout& layout, const ShownChannels& shown,
                      const Visit& visit) {
  const T* const first = image + shown.first * layout.channel_step;
  for (int64_t y = 0; y < layout.height; ++y)
    for (int64_t x = 0; x < layout.width; ++x)
      for (int64_t c = 0; c < shown.count; ++c)
        visit(first[y * layout.row_step + x * layout.column_step + c * layout.channel_step]);
}

template <typename T>
void stretch(const T* image, const ImageLayout& layout, const ShownChannels& shown,
             GreyOrRgb& out) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for_each_element(image, layout, shown, [&](T value) {
    const auto number = static_cast<double>(value);
    if (!std::isfinite(number)) return;
    low = std::min(low, number);
    high = std::max(high, number);
  });
  // Halves, because the difference of two doubles may be beyond them.
  const double range = high / 2 - low / 2;
  for_each_element(image, layout, shown, [&](T value) {
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
  idf::visit_element_type(array.type(), [&]<typename T>(T) {
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
  const size_t rank = shape.size();
  if (rank < 2) return std::nullopt;
  auto layout = rank == 2 ? std::nullopt : layout_of_one(shape, 3);
  size_t of_one = 3;
  if (!layout) {
    // Without an axis for channels.
    const bool is_large = shape[rank - 2] >= kMinMatrixSide && shape[rank - 1] >= kMinMatrixSide;
    if ((rank == 2 || is_float) && !is_large) return std::nullopt;
    layout = layout_of_one(shape, 2);
    of_one = 2;
  }
  if (!layout) return std::nullopt;
  for (size_t i = 0; i + of_one < rank; ++i) layout->images *= shape[i];
  layout->image_step = layout->height * layout->width * layout->channels;
  return layout;
}

int64_t FoundImages::looks() const {
  int64_t sum = 0;
  for (const ImageMember& member : members) sum += member.layout.images * member.layout.looks();
  return sum;
}

FoundImages find_images(idf::Data& value) {
  ImageFinder finder;
  idf::walk_values(
      value, [&finder](const std::string& path, idf::Data& each) { finder.visit(path, each); });
  return std::move(finder.found);
}

GreyOrRgb pixels_of(const idf::NdArray& array, const ImageLayout& layout, int64_t index,
                    int64_t look) {
  const ShownChannels shown = shown_in(layout, look);
  GreyOrRgb out;
  out.channels = static_cast<int>(shown.count);
  out.pixels.reserve(static_cast<size_t>(layout.width * layout.height * shown.count));
  idf::visit_element_type(array.type(), [&]<typename T>(T) {
    const T* const image = array.values<T>().data() + index * layout.image_step;
    const bool is_dense = layout.channels == shown.count && layout.column_step == shown.count;
    if constexpr (!std::is_same_v<T, uint8_t>)
      stretch(image, layout, shown, out);
    else if (is_dense)
      out.pixels.assign(image, image + layout.height * layout.row_step);
    else
      for_each_element(image, layout, shown,
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
