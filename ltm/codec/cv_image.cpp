// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/cv_image.h"

#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace engram::ltm::cv_image {

namespace {

int cv_type(idf::ElementType type, const idf::Shape& shape) {
  return CV_MAKETYPE(type == idf::ElementType::kUInt16 ? CV_16U : CV_8U,
                     static_cast<int>(shape[2]));
}

}  // namespace

bool fits(idf::ElementType type, const idf::Shape& shape, int64_t max_side, bool allows_16_bits) {
  if (shape.size() != 3 || shape[0] < 1 || shape[1] < 1 || shape[0] > max_side ||
      shape[1] > max_side)
    return false;
  if (type == idf::ElementType::kUInt8) return shape[2] == 1 || shape[2] == 3;
  return allows_16_bits && type == idf::ElementType::kUInt16 && shape[2] == 1;
}

Result<std::vector<std::byte>> encode(std::string_view format, const idf::NdArray& array,
                                      const std::vector<int>& parameters) {
  const idf::Shape& shape = array.shape();
  try {
    // cv::Mat has no const view, but the array is only read.
    const cv::Mat view(static_cast<int>(shape[0]), static_cast<int>(shape[1]),
                       cv_type(array.type(), shape), const_cast<std::byte*>(array.bytes().data()));
    // Convert into a separate Mat, because a Mat that shares the view's pixels would be changed in
    // place.
    cv::Mat bgr;
    if (shape[2] == 3)
      cv::cvtColor(view, bgr, cv::COLOR_RGB2BGR);
    else
      bgr = view;
    std::vector<uchar> file;
    if (!cv::imencode("." + std::string(format), bgr, file, parameters))
      return invalid_argument("{}: the encoder refused", format);
    const auto bytes = std::as_bytes(std::span(file));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  } catch (const cv::Exception& error) {
    return invalid_argument("{}: {}", format, error.what());
  }
}

Result<idf::NdArray> decode(std::string_view format, std::span<const std::byte> bytes,
                            idf::ElementType type, const idf::Shape& shape) {
  if (bytes.size() > std::numeric_limits<int>::max())
    return data_loss("{}: {} bytes are too many", format, bytes.size());
  try {
    const cv::Mat packed(1, static_cast<int>(bytes.size()), CV_8U,
                         const_cast<std::byte*>(bytes.data()));
    cv::Mat image = cv::imdecode(packed, cv::IMREAD_UNCHANGED);
    if (image.rows != shape[0] || image.cols != shape[1] || image.type() != cv_type(type, shape))
      return data_loss("{}: damaged, or not {} {}", format, to_string(type), idf::to_string(shape));
    std::vector<std::byte> plain(image.total() * image.elemSize());
    cv::Mat out(image.rows, image.cols, image.type(), plain.data());
    if (shape[2] == 3)
      cv::cvtColor(image, out, cv::COLOR_BGR2RGB);
    else
      image.copyTo(out);
    return idf::NdArray::create(type, shape, Buffer::take(std::move(plain)));
  } catch (const cv::Exception& error) {
    return data_loss("{}: {}", format, error.what());
  }
}

}  // namespace engram::ltm::cv_image
