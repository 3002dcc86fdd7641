// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/frame_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace engram::datasets {

namespace {

// swscale may write whole vectors, so lines are padded to a multiple of this.
constexpr int kLineAlignment = 64;

/// The part of a picture that is kept.
cv::Rect crop_of(int width, int height, bool crops_square) {
  if (!crops_square) return {0, 0, width, height};
  const int side = std::min(width, height);
  return {(width - side) / 2, (height - side) / 2, side, side};
}

int scaled(int size, int by, int of) {
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(size) * by / of)));
}

cv::Size output_size(const VideoInfo& info, const VideoReader::Options& options) {
  const cv::Size from = crop_of(info.width, info.height, options.crops_square).size();
  if (options.width == 0 && options.height == 0) return from;
  if (options.width == 0) return {scaled(from.width, options.height, from.height), options.height};
  if (options.height == 0) return {options.width, scaled(from.height, options.width, from.width)};
  return {options.width, options.height};
}

/// Restricts the frame to `crop`, if that starts at a sample of every plane. Returns false if not.
bool cut(AVFrame& frame, const cv::Rect& crop) {
  const cv::Point end = crop.br();
  int log2_width = 0, log2_height = 0;
  const auto format = static_cast<AVPixelFormat>(frame.format);
  if (av_pix_fmt_get_chroma_sub_sample(format, &log2_width, &log2_height) < 0 ||
      crop.x % (1 << log2_width) != 0 || crop.y % (1 << log2_height) != 0)
    return false;
  frame.crop_left = static_cast<size_t>(crop.x);
  frame.crop_top = static_cast<size_t>(crop.y);
  frame.crop_right = static_cast<size_t>(frame.width - end.x);
  frame.crop_bottom = static_cast<size_t>(frame.height - end.y);
  return av_frame_apply_cropping(&frame, AV_FRAME_CROP_UNALIGNED) >= 0;
}

}  // namespace

FrameImages::FrameImages(const VideoInfo& info, const VideoReader::Options& options)
    : size_(output_size(info, options)), crops_square_(options.crops_square) {}

Result<idf::NdArray> FrameImages::make(const DecodedPicture& picture) {
  const libav::Frame frame(av_frame_clone(&picture.frame()));  // Shares the pixels; cropped below.
  if (!frame) return resource_exhausted("no memory for a frame");
  try {
    return convert(*frame);
  } catch (const cv::Exception& error) {
    return invalid_argument("cannot scale a frame: {}", error.what());
  }
}

Result<idf::NdArray> FrameImages::convert(AVFrame& frame) {
  cv::Rect crop = crop_of(frame.width, frame.height, crops_square_);
  libav::PixelFormat format = libav::format_of(frame);
  if (cut(frame, crop)) {
    crop = {0, 0, frame.width, frame.height};
    format.width = frame.width;
    format.height = frame.height;
  }
  const bool scales = can_scale_planes(format, crop);
  ENGRAM_RETURN_IF_ERROR(prepare(format, scales));
  const std::array<uint8_t*, 1> lines{rgb_.data};
  const std::array<int, 1> strides{static_cast<int>(rgb_.step)};
  if (sws_scale(converter_.get(), frame.data, frame.linesize, 0, frame.height, lines.data(),
                strides.data()) != (scales ? size_.height : frame.height))
    return invalid_argument("the colours of a frame cannot be converted");
  return fit(rgb_(scales ? cv::Rect({0, 0}, size_) : crop));
}

/// Averaging before the conversion of colours gives the same result up to rounding, and is several
/// times faster.
bool FrameImages::can_scale_planes(const libav::PixelFormat& format, const cv::Rect& crop) const {
  return crop.size() == cv::Size(format.width, format.height) && crop.size() != size_ &&
         libav::shrinks_all_planes(format, libav::rgb_format(size_.width, size_.height));
}

Status FrameImages::prepare(const libav::PixelFormat& format, bool scales) {
  if (converter_ && format == format_) return {};
  const cv::Size to = scales ? size_ : cv::Size(format.width, format.height);
  const int stride = (to.width + kLineAlignment - 1) / kLineAlignment * kLineAlignment;
  ENGRAM_ASSIGN_OR_RETURN(converter_,
                          libav::make_converter(format, libav::rgb_format(to.width, to.height)));
  rgb_.create(to.height, stride, CV_8UC3);
  format_ = format;
  return {};
}

idf::NdArray FrameImages::fit(const cv::Mat& from) const {
  std::vector<uint8_t> pixels(static_cast<size_t>(size_.area()) * 3);
  cv::Mat to(size_, CV_8UC3, pixels.data());
  const bool shrinks = size_.width <= from.cols && size_.height <= from.rows;
  if (from.size() == size_)
    from.copyTo(to);
  else
    cv::resize(from, to, size_, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  return idf::NdArray::take(shape(), std::move(pixels));
}

}  // namespace engram::datasets
