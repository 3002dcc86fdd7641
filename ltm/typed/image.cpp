// SPDX-License-Identifier: Apache-2.0
#include "ltm/typed/image.h"

#include <cstring>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>

namespace engram::typed {

namespace {

using idf::ElementType;

/// The OpenCV code of an array's elements; nothing where OpenCV has no such elements.
std::optional<int> depth_of(ElementType element) {
  switch (element) {
    case ElementType::kUInt8:
      return CV_8U;
    case ElementType::kInt8:
      return CV_8S;
    case ElementType::kUInt16:
      return CV_16U;
    case ElementType::kInt16:
      return CV_16S;
    case ElementType::kInt32:
      return CV_32S;
    case ElementType::kFloat32:
      return CV_32F;
    case ElementType::kFloat64:
      return CV_64F;
    default:
      return std::nullopt;
  }
}

std::optional<ElementType> element_of(int depth) {
  for (const ElementType element :
       {ElementType::kUInt8, ElementType::kInt8, ElementType::kUInt16, ElementType::kInt16,
        ElementType::kInt32, ElementType::kFloat32, ElementType::kFloat64})
    if (depth_of(element) == depth) return element;
  return std::nullopt;
}

/// The elements and channels of pixels.
struct Pixels {
  ElementType element;
  int64_t channels;
};

Pixels pixels_of(idf::PixelType pixel) {
  switch (pixel) {
    case idf::PixelType::kRgb24:
      return {ElementType::kUInt8, 3};
    case idf::PixelType::kMono8:
      return {ElementType::kUInt8, 1};
    case idf::PixelType::kDepth32:
      return {ElementType::kFloat32, 1};
    case idf::PixelType::kDepth16:
      break;
  }
  return {ElementType::kUInt16, 1};
}

/// Lets Mats use the bytes of buffers: OpenCV counts the Mats, and the last one releases the
/// buffer.
class BufferAllocator : public cv::MatAllocator {
 public:
  /// Never destroyed, because Mats in static variables may outlive everything.
  static const BufferAllocator& instance() {
    static const BufferAllocator* const kInstance = new BufferAllocator();
    return *kInstance;
  }

  [[nodiscard]] cv::UMatData* hold(const Buffer& buffer) const {
    auto held = std::make_unique<cv::UMatData>(this);
    // OpenCV has no read-only Mat; the header forbids writing.
    held->data = held->origdata = reinterpret_cast<uchar*>(const_cast<std::byte*>(buffer.data()));
    held->size = buffer.size();
    held->refcount = 1;
    held->userdata = new Buffer(buffer);
    return held.release();
  }

  /// The buffer below a Mat; null where it came from another allocator.
  [[nodiscard]] const Buffer* buffer_of(const cv::Mat& mat) const {
    return mat.u != nullptr && mat.u->currAllocator == this ? static_cast<Buffer*>(mat.u->userdata)
                                                            : nullptr;
  }

  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step,
                         cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override {
    if (data == nullptr) return;
    delete static_cast<Buffer*>(data->userdata);
    delete data;
  }
};

/// The bytes of a Mat without gaps, kept alive by their current owner.
Buffer share(const cv::Mat& mat) {
  const auto* data = reinterpret_cast<const std::byte*>(mat.data);
  const size_t size = mat.total() * mat.elemSize();
  // Round trips must not wrap a Mat around a buffer around a Mat.
  if (const Buffer* below = BufferAllocator::instance().buffer_of(mat))
    return Buffer(below->owner(), {data, size});
  return Buffer(std::make_shared<const cv::Mat>(mat), {data, size});
}

}  // namespace

std::optional<idf::NdArray> array_of(const cv::Mat& mat, idf::PixelType pixel) {
  if (mat.dims > 2) return std::nullopt;
  idf::Shape shape{mat.rows, mat.cols, mat.channels()};
  auto element = element_of(mat.depth());
  if (mat.empty()) {
    const Pixels pixels = pixels_of(pixel);
    element = pixels.element;
    shape[2] = pixels.channels;
  }
  if (!element) return std::nullopt;
  const bool is_owned_without_gaps = mat.u != nullptr && mat.isContinuous();
  Buffer bytes = mat.empty() ? Buffer() : share(is_owned_without_gaps ? mat : mat.clone());
  auto array = idf::NdArray::create(*element, std::move(shape), std::move(bytes));
  return array.ok() ? std::optional(std::move(*array)) : std::nullopt;
}

std::optional<cv::Mat> mat_of(const idf::NdArray& array) {
  const auto depth = depth_of(array.type());
  const idf::Shape& shape = array.shape();
  if (!depth || shape.size() != 3 || shape[2] < 1 || shape[2] > CV_CN_MAX) return std::nullopt;
  if (shape[0] > std::numeric_limits<int>::max() || shape[1] > std::numeric_limits<int>::max())
    return std::nullopt;
  const int rows = static_cast<int>(shape[0]);
  const int cols = static_cast<int>(shape[1]);
  const int type = CV_MAKETYPE(*depth, static_cast<int>(shape[2]));
  if (array.bytes().empty()) return cv::Mat(rows, cols, type);
  cv::UMatData* held = BufferAllocator::instance().hold(array.buffer());
  cv::Mat mat(rows, cols, type, held->data);
  mat.u = held;
  return mat;
}

idf::Data Convert<cv::Mat>::write(const cv::Mat& value, const idf::Type& type) {
  auto array = array_of(value, type.get<idf::types::Image>().pixel);
  return array ? idf::Data(std::move(*array)) : idf::Data(idf::None{});
}

bool Convert<cv::Mat>::read(const idf::Data& data, const idf::Type& type, cv::Mat& value) {
  const auto* array = data.get_if<idf::NdArray>();
  const auto* needed = type.get_if<idf::types::Image>();
  if (array == nullptr || needed == nullptr || array->rank() != 3) return false;
  const Pixels pixels = pixels_of(needed->pixel);
  const idf::Shape& shape = array->shape();
  const bool fits = array->type() == pixels.element && shape[2] == pixels.channels &&
                    (needed->height == idf::kFreeSize || needed->height == shape[0]) &&
                    (needed->width == idf::kFreeSize || needed->width == shape[1]);
  if (!fits) return false;
  auto mat = mat_of(*array);
  if (mat) value = std::move(*mat);
  return mat.has_value();
}

bool Convert<cv::Mat>::equal(const cv::Mat& a, const cv::Mat& b) {
  if (a.dims > 2 || b.dims > 2 || a.size() != b.size()) return false;
  // An empty Mat has no kind of pixels that could differ.
  if (a.empty()) return true;
  if (a.type() != b.type()) return false;
  const size_t row_bytes = static_cast<size_t>(a.cols) * a.elemSize();
  for (int row = 0; row < a.rows; ++row)
    if (std::memcmp(a.ptr(row), b.ptr(row), row_bytes) != 0) return false;
  return true;
}

}  // namespace engram::typed
