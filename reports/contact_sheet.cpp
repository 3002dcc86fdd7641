// SPDX-License-Identifier: Apache-2.0
#include "reports/contact_sheet.h"

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "ltm/codec/codec.h"
#include "ltm/core/file.h"
#include "ltm/idf/layout.h"

namespace engram::reports {

namespace {

constexpr int kMargin = 6;
constexpr int kLineHeight = 15;
/// Images are magnified by whole numbers until they are at least this wide. Whole numbers keep
/// every pixel the same size.
constexpr int kMinWidth = 128;
constexpr int kHeaderHeight = 22;
constexpr double kFontScale = 0.42;

/// Copies an image into the form of OpenCV: three channels, blue first.
cv::Mat to_bgr(const idf::NdArray& image) {
  const int channels = static_cast<int>(image.shape()[2]);
  const cv::Mat view(static_cast<int>(image.shape()[0]), static_cast<int>(image.shape()[1]),
                     CV_8UC(channels), const_cast<std::byte*>(image.bytes().data()));
  cv::Mat bgr;
  cv::cvtColor(view, bgr, channels == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_GRAY2BGR);
  return bgr;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Writes lines of text, the first one at `at`.
void write_text(cv::Mat& sheet, const std::string& text, cv::Point at) {
  for (const std::string& line : lines_of(text)) {
    cv::putText(sheet, line, at, cv::FONT_HERSHEY_SIMPLEX, kFontScale, cv::Scalar(40, 40, 40), 1,
                cv::LINE_AA);
    at.y += kLineHeight;
  }
}

/// The width of the widest label.
int label_width(const std::vector<PictureRow>& rows) {
  int width = 0;
  for (const PictureRow& row : rows)
    for (const std::string& line : lines_of(row.label)) {
      int baseline = 0;
      const cv::Size size =
          cv::getTextSize(line, cv::FONT_HERSHEY_SIMPLEX, kFontScale, 1, &baseline);
      width = std::max(width, size.width);
    }
  return width + 2 * kMargin;
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
  const int times = (kMinWidth + static_cast<int>(shape[1]) - 1) / static_cast<int>(shape[1]);
  const cv::Size size(times * static_cast<int>(shape[1]), times * static_cast<int>(shape[0]));
  const int columns = static_cast<int>(rows.front().images.size());
  const int labels = label_width(rows);
  size_t max_lines = 0;
  for (const PictureRow& row : rows) max_lines = std::max(max_lines, lines_of(row.label).size());
  const int row_height = std::max(size.height, static_cast<int>(max_lines) * kLineHeight);
  cv::Mat sheet(kHeaderHeight + static_cast<int>(rows.size()) * (row_height + kMargin),
                labels + columns * (size.width + kMargin), CV_8UC3, cv::Scalar::all(255));
  for (int column = 0; column < columns; ++column)
    if (static_cast<size_t>(column) < column_labels.size())
      write_text(sheet, column_labels[static_cast<size_t>(column)],
                 {labels + column * (size.width + kMargin), kHeaderHeight - 7});
  int top = kHeaderHeight;
  for (const PictureRow& row : rows) {
    const auto lines = static_cast<int>(lines_of(row.label).size());
    write_text(sheet, row.label, {kMargin, top + (row_height - (lines - 1) * kLineHeight) / 2});
    int left = labels;
    for (const idf::NdArray& image : row.images) {
      if (left + size.width > sheet.cols) break;
      cv::Mat place = sheet(cv::Rect({left, top}, size));
      cv::resize(to_bgr(image), place, size, 0, 0, cv::INTER_NEAREST);
      left += size.width + kMargin;
    }
    top += row_height + kMargin;
  }
  return sheet;
}

}  // namespace

const idf::NdArray* first_image(const idf::Data& data) {
  const idf::Layout layout = idf::Layout::of(data);
  for (const idf::TensorMember& member : layout.members())
    if (member.kind == idf::MemberKind::kImage && member.type == idf::ElementType::kUInt8)
      return data.at(member.path)->get_if<idf::NdArray>();
  return nullptr;
}

idf::NdArray difference(const idf::NdArray& a, const idf::NdArray& b) {
  std::vector<uint8_t> pixels;
  const auto left = a.values<uint8_t>();
  const auto right = b.values<uint8_t>();
  for (size_t i = 0; i < left.size(); ++i)
    pixels.push_back(static_cast<uint8_t>(
        std::min(255, kDifferenceGain * std::abs(int{left[i]} - int{right[i]}))));
  return idf::NdArray::take(a.shape(), std::move(pixels));
}

Status write_contact_sheet(const std::filesystem::path& path, const std::vector<PictureRow>& rows,
                           const std::vector<std::string>& column_labels) {
  ENGRAM_RETURN_IF_ERROR(check(rows));
  try {
    cv::Mat sheet = draw(rows, column_labels);
    cv::cvtColor(sheet, sheet, cv::COLOR_BGR2RGB);
    const auto image =
        idf::NdArray::take<uint8_t>({sheet.rows, sheet.cols, 3}, {sheet.datastart, sheet.dataend});
    auto png = ltm::find_codec("png")->encode(image);
    if (!png.ok()) return png.status().with_context("'" + path.string() + "'");
    return replace_file(path, *png);
  } catch (const cv::Exception& error) {
    return unavailable("'{}': {}", path.string(), error.what());
  }
}

}  // namespace engram::reports
