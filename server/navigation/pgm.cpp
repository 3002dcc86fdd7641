// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/pgm.h"

#include <charconv>
#include <optional>

#include "server/navigation/grid_frame.h"

namespace engram::navigation {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}

/// Reads whole numbers between blanks and comments, which go from # to the end of a line.
class PgmNumbers {
 public:
  explicit PgmNumbers(std::string_view bytes) : bytes_(bytes) {}

  /// Nothing at the end, and where something else stands there.
  std::optional<int> next() {
    while (at_ < bytes_.size() && (is_blank(bytes_[at_]) || bytes_[at_] == '#')) {
      if (bytes_[at_] == '#')
        while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      else
        ++at_;
    }
    int number = 0;
    const char* first = bytes_.data() + at_;
    const char* end = bytes_.data() + bytes_.size();
    const auto [last, error] = std::from_chars(first, end, number);
    if (error != std::errc() || number < 0) return {};
    at_ += static_cast<size_t>(last - first);
    return number;
  }

  [[nodiscard]] std::string_view rest() const { return bytes_.substr(at_); }

 private:
  std::string_view bytes_;
  size_t at_ = 0;
};

}  // namespace

Result<GreyPicture> parse_pgm(std::string_view bytes, const std::string& name) {
  const bool is_binary = bytes.starts_with("P5");
  if (!is_binary && !bytes.starts_with("P2"))
    return data_loss("{}: does not begin with P2 or P5, needs a PGM file", name);
  PgmNumbers header(bytes.substr(2));
  const auto width = header.next();
  const auto height = header.next();
  const auto max_value = header.next();
  if (!width || !height || !max_value)
    return data_loss("{}: its header ends early, needs width, height and the largest value", name);
  if (*width < 1 || *height < 1 || int64_t{*width} * *height > GridFrame::kMaxCells)
    return data_loss("{}: has {} x {} pixels, needs 1 to {}", name, *width, *height,
                     GridFrame::kMaxCells);
  if (*max_value < 1 || *max_value > 65535)
    return data_loss("{}: its largest value is {}, needs 1 to 65535", name, *max_value);
  const auto count = static_cast<size_t>(*width) * static_cast<size_t>(*height);
  const size_t pixel_bytes = *max_value > 255 ? 2 : 1;
  // Checked before memory is taken: a header of 20 bytes may promise 64 million pixels. A number in
  // text takes two bytes, but for the last one.
  std::string_view rest = header.rest();
  const size_t needed = is_binary ? 1 + count * pixel_bytes : 2 * count;
  if (rest.size() < needed)
    return data_loss("{}: has {} bytes after its header, {} x {} pixels need {}", name, rest.size(),
                     *width, *height, needed);
  GreyPicture picture{cv::Mat(*height, *width, CV_16UC1), *max_value};
  auto* pixels = picture.pixels.ptr<uint16_t>();
  if (is_binary) {
    if (!is_blank(rest.front()))
      return data_loss("{}: has no blank between header and pixels", name);
    rest.remove_prefix(1);
    for (size_t i = 0; i < count; ++i) {
      const auto byte = [&](size_t at) { return static_cast<uint8_t>(rest[at]); };
      pixels[i] =
          pixel_bytes == 1 ? byte(i) : static_cast<uint16_t>(byte(2 * i) << 8 | byte(2 * i + 1));
      if (pixels[i] > *max_value)
        return data_loss("{}: pixel {} is {}, its largest value is {}", name, i, pixels[i],
                         *max_value);
    }
    return picture;
  }
  for (size_t i = 0; i < count; ++i) {
    const auto pixel = header.next();
    if (!pixel || *pixel > *max_value)
      return data_loss("{}: pixel {} is missing or no number from 0 to {}", name, i, *max_value);
    pixels[i] = static_cast<uint16_t>(*pixel);
  }
  return picture;
}

std::string pgm_of(const cv::Mat& pixels) {
  std::string bytes = fmt::format("P5\n{} {}\n255\n", pixels.cols, pixels.rows);
  for (int row = 0; row < pixels.rows; ++row)
    bytes.append(reinterpret_cast<const char*>(pixels.ptr<uint8_t>(row)),
                 static_cast<size_t>(pixels.cols));
  return bytes;
}

}  // namespace engram::navigation
