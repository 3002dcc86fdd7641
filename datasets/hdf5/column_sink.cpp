// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "datasets/hdf5/row_sink.h"

namespace engram::datasets {

namespace {

constexpr uint64_t kWrittenBlockBytes = 1 << 20;
constexpr uint64_t kWrittenTextRows = 256;

uint64_t rows_written_together(const h5::ArrayInfo& array) {
  if (array.chunk_rows > 0) return array.chunk_rows;
  if (!array.element.is_number()) return kWrittenTextRows;
  return std::max<uint64_t>(kWrittenBlockBytes / std::max<uint64_t>(array.row_bytes(), 1), 1);
}

std::string described(const RowForm& form) {
  std::string shape;
  for (const uint64_t size : form.shape)
    shape += fmt::format("{}{}", shape.empty() ? "" : ", ", size);
  return fmt::format("{} [{}]", dtype_name(form.element), shape);
}

class ColumnWriter final : public RowSink {
 public:
  ColumnWriter(h5::File& file, std::string path, const Column& column)
      : file_(file),
        path_(std::move(path)),
        column_(column),
        block_rows_(rows_written_together(column.array)) {}

  Status add(const idf::Data& value) override;
  Status finish() override;

 private:
  Status flush();

  h5::File& file_;
  std::string path_;
  const Column& column_;
  uint64_t block_rows_ = 1;
  uint64_t written_ = 0;
  uint64_t waiting_ = 0;
  std::vector<std::byte> bytes_;
  std::vector<std::string> texts_;
};

Status ColumnWriter::add(const idf::Data& value) {
  const idf::Data* member = value.at(column_.member);
  const auto form = member == nullptr ? std::nullopt : row_form(*member);
  if (form != column_.form)
    return invalid_argument("member '{}' is {}, array '{}' needs {} in every row", column_.member,
                            form ? described(*form) : "none", path_, described(column_.form));
  const h5::Element& element = column_.array.element;
  if (element.is_number()) {
    const auto bytes = row_bytes(*member);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  } else {
    texts_.push_back(member->get<std::string>());
    if (element.kind == h5::Kind::kFixedText && texts_.back().size() > element.text_bytes)
      return invalid_argument("member '{}' has {} bytes, array '{}' holds {}", column_.member,
                              texts_.back().size(), path_, element.text_bytes);
  }
  return ++waiting_ < block_rows_ ? Status() : flush();
}

Status ColumnWriter::flush() {
  ENGRAM_RETURN_IF_ERROR(file_.write_array_rows(path_, written_, bytes_));
  ENGRAM_RETURN_IF_ERROR(file_.write_array_texts(path_, written_, texts_));
  written_ += waiting_;
  waiting_ = 0;
  bytes_.clear();
  texts_.clear();
  return {};
}

Status ColumnWriter::finish() {
  ENGRAM_RETURN_IF_ERROR(flush());
  return file_.finish_array(path_);
}

}  // namespace

Result<std::unique_ptr<RowSink>> make_column_sink(h5::File& file, const std::string& path,
                                                  const Column& column, uint64_t rows) {
  h5::ArrayInfo array = column.array;
  array.shape[0] = rows;
  ENGRAM_RETURN_IF_ERROR(file.create_array(path, array));
  return std::unique_ptr<RowSink>(std::make_unique<ColumnWriter>(file, path, column));
}

}  // namespace engram::datasets
