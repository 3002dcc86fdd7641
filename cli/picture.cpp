// SPDX-License-Identifier: Apache-2.0
#include "cli/picture.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "ltm/core/file.h"

namespace engram::cli {

namespace {

constexpr int kMargin = 6;
constexpr int kLabelWidth = 130;
constexpr int kHeaderHeight = 22;
constexpr double kFontScale = 0.42;

/// A copy as OpenCV shows it: three channels, blue first.
cv::Mat to_bgr(const idf::NdArray& image) {
  const int channels = static_cast<int>(image.shape()[2]);
  const cv::Mat view(static_cast<int>(image.shape()[0]), static_cast<int>(image.shape()[1]),
                     CV_8UC(channels), const_cast<std::byte*>(image.bytes().data()));
  cv::Mat bgr;
  cv::cvtColor(view, bgr, channels == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_GRAY2BGR);
  return bgr;
}

void write_text(cv::Mat& sheet, const std::string& text, cv::Point at) {
  cv::putText(sheet, text, at, cv::FONT_HERSHEY_SIMPLEX, kFontScale, cv::Scalar(40, 40, 40), 1,
              cv::LINE_AA);
}

bool fits(const idf::NdArray& image, const idf::Shape& shape) {
  return image.type() == idf::ElementType::kUInt8 && image.shape() == shape;
}

Status check(const std::vector<PictureRow>& rows) {
  if (rows.empty() || rows.front().images.empty())
    return invalid_argument("contact sheet: there are no images");
  const idf::Shape shape = rows.front().images.front().shape();
  if (shape.size() != 3 || (shape[2] != 3 && shape[2] != 1))
    return invalid_argument("contact sheet: needs images of 3 channels or 1, found {}",
                            idf::to_string(shape));
  for (const PictureRow& row : rows)
    for (const idf::NdArray& image : row.images)
      if (!fits(image, shape))
        return invalid_argument("contact sheet: found images of different sizes");
  return {};
}

cv::Mat draw(const std::vector<PictureRow>& rows, const std::vector<std::string>& column_labels) {
  const auto& shape = rows.front().images.front().shape();
  const int height = static_cast<int>(shape[0]);
  const int width = static_cast<int>(shape[1]);
  const int columns = static_cast<int>(rows.front().images.size());
  cv::Mat sheet(kHeaderHeight + static_cast<int>(rows.size()) * (height + kMargin),
                kLabelWidth + columns * (width + kMargin), CV_8UC3, cv::Scalar::all(255));
  for (int column = 0; column < columns; ++column)
    if (static_cast<size_t>(column) < column_labels.size())
      write_text(sheet, column_labels[static_cast<size_t>(column)],
                 {kLabelWidth + column * (width + kMargin), kHeaderHeight - 7});
  int top = kHeaderHeight;
  for (const PictureRow& row : rows) {
    write_text(sheet, row.label, {kMargin, top + height / 2});
    int left = kLabelWidth;
    for (const idf::NdArray& image : row.images) {
      if (left + width > sheet.cols) break;
      to_bgr(image).copyTo(sheet(cv::Rect(left, top, width, height)));
      left += width + kMargin;
    }
    top += height + kMargin;
  }
  return sheet;
}

}  // namespace

Status write_contact_sheet(const std::filesystem::path& path, const std::vector<PictureRow>& rows,
                           const std::vector<std::string>& column_labels) {
  ENGRAM_RETURN_IF_ERROR(check(rows));
  try {
    std::vector<uchar> png;
    if (!cv::imencode(".png", draw(rows, column_labels), png))
      return unavailable("'{}': the PNG encoder refused", path.string());
    return replace_file(path, std::as_bytes(std::span(png)));
  } catch (const cv::Exception& error) {
    return unavailable("'{}': {}", path.string(), error.what());
  }
}

}  // namespace engram::cli
