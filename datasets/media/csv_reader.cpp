// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/csv_reader.h"

#include <array>
#include <string_view>
#include <utility>

namespace engram::datasets {

namespace {

constexpr size_t kBufferBytes = size_t{1} << 18;
constexpr size_t kMaxCellBytes = size_t{1} << 20;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

}  // namespace

Result<CsvReader> CsvReader::open(const std::filesystem::path& path) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  if (kind == std::filesystem::file_type::not_found)
    return not_found("table '{}': there is no such file", path.string());
  if (kind != std::filesystem::file_type::regular)
    return invalid_argument("table '{}': needs a file", path.string());
  std::ifstream file(path, std::ios::binary);
  if (!file) return unavailable("table '{}': cannot open", path.string());
  CsvReader reader(path, std::move(file));
  reader.skip_mark();
  return reader;
}

CsvReader::CsvReader(std::filesystem::path path, std::ifstream file)
    : path_(std::move(path)), file_(std::move(file)), buffer_(kBufferBytes) {}

void CsvReader::fill() {
  file_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  at_ = 0;
  end_ = static_cast<size_t>(file_.gcount());
}

int CsvReader::peek() {
  if (at_ == end_) fill();
  return at_ == end_ ? -1 : static_cast<unsigned char>(buffer_[at_]);
}

int CsvReader::get() {
  const int byte = peek();
  if (byte < 0) return byte;
  ++at_;
  if (byte == '\n') ++line_;
  return byte;
}

void CsvReader::skip_mark() {
  fill();
  if (std::string_view(buffer_.data(), end_).starts_with(kByteOrderMark))
    at_ = kByteOrderMark.size();
}

/// Returns true if `byte`, just read, ends a line; also reads the LF that follows a CR.
bool CsvReader::takes_line_end(int byte) {
  if (byte == '\n') return true;
  if (byte != '\r' || peek() != '\n') return false;
  get();
  return true;
}

/// Returns false at the end of the file.
bool CsvReader::skip_empty_lines() {
  while (peek() == '\n' || peek() == '\r') get();
  return peek() >= 0;
}

Status CsvReader::broken(uint64_t line, std::string_view what) const {
  return invalid_argument("table '{}': line {}: {}", path_.string(), line, what);
}

/// Reads up to and including the closing quote; the opening one was read.
Status CsvReader::read_quoted(std::string& cell) {
  const uint64_t first_line = line_;
  while (true) {
    const int byte = get();
    if (byte < 0) return broken(first_line, "found a quote that never closes, needs a second one");
    if (byte == '"') {
      if (peek() != '"') return {};
      get();
    }
    cell.push_back(static_cast<char>(byte));
    if (cell.size() > kMaxCellBytes)
      return broken(first_line, "a quoted cell exceeds 1 MiB, needs a closing quote before");
  }
}

/// Reads one cell, up to but not including its comma or line end.
Status CsvReader::read_cell(std::string& cell) {
  if (peek() == '"') {
    get();
    ENGRAM_RETURN_IF_ERROR(read_quoted(cell));
    const int after = peek();
    if (after < 0 || after == ',' || after == '\n' || after == '\r') return {};
    return broken(line_, fmt::format("found '{}' after a closing quote, needs a comma",
                                     static_cast<char>(after)));
  }
  for (int byte = peek(); byte >= 0 && byte != ',' && byte != '\n' && byte != '\r'; byte = peek()) {
    if (byte == '"') return broken(line_, "found a quote inside a cell, needs the cell quoted");
    if (cell.size() >= kMaxCellBytes) return broken(line_, "a cell exceeds 1 MiB, needs a comma");
    cell.push_back(static_cast<char>(get()));
  }
  return {};
}

Result<bool> CsvReader::next(std::vector<std::string>& cells) {
  const bool has_more = skip_empty_lines();
  if (file_.bad()) return unavailable("table '{}': line {}: cannot read", path_.string(), line_);
  if (!has_more) return false;
  record_line_ = line_;
  // Strings are reused, so that they keep their memory from record to record.
  for (size_t count = 0;; ++count) {
    if (count == cells.size()) cells.emplace_back();
    cells[count].clear();
    ENGRAM_RETURN_IF_ERROR(read_cell(cells[count]));
    const int byte = get();
    if (byte == ',') continue;
    if (byte >= 0 && !takes_line_end(byte))
      return broken(record_line_, "found a carriage return inside a line, needs LF or CRLF");
    cells.resize(count + 1);
    if (file_.bad()) return unavailable("table '{}': line {}: cannot read", path_.string(), line_);
    return true;
  }
}

}  // namespace engram::datasets
