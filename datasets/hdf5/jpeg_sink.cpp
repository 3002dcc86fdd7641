// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "datasets/hdf5/row_sink.h"
#include "ltm/codec/codec.h"
#include "ltm/core/file.h"
#include "ltm/core/log.h"

namespace engram::datasets {

namespace {

/// ALOHA stores sizes as float32, which holds whole numbers up to this exactly.
constexpr size_t kMaxFileBytes = 1 << 24;

class JpegSink final : public RowSink {
 public:
  JpegSink(h5::File& file, std::string path, const Column& column,
           std::shared_ptr<const ltm::Codec> codec, File waiting, std::vector<float>& sizes)
      : file_(file),
        path_(std::move(path)),
        column_(column),
        codec_(std::move(codec)),
        waiting_(std::move(waiting)),
        sizes_(sizes) {}

  ~JpegSink() override {
    if (const Status status = remove_file(waiting_.path()); !status.ok())
      log::warning("what waited for an export stays: {}", status.message());
  }

  Status add(const idf::Data& value) override {
    const idf::Data* member = value.at(column_.member);
    const auto form = member == nullptr ? std::nullopt : row_form(*member);
    if (form != column_.form)
      return invalid_argument("member '{}': array '{}' needs images of one size", column_.member,
                              path_);
    ENGRAM_ASSIGN_OR_RETURN(const auto image, codec_->encode(member->get<idf::NdArray>()));
    if (image.size() > kMaxFileBytes)
      return invalid_argument("member '{}': a JPEG file of {} bytes, at most {} fit",
                              column_.member, image.size(), kMaxFileBytes);
    sizes_.push_back(static_cast<float>(image.size()));
    longest_ = std::max<uint64_t>(longest_, image.size());
    return waiting_.append(image);
  }

  Status finish() override {
    ENGRAM_RETURN_IF_ERROR(
        file_.create_array(path_, {h5::Element{}, {sizes_.size(), longest_}, 1, 0}));
    ENGRAM_ASSIGN_OR_RETURN(const File images, File::open(waiting_.path(), File::Mode::kRead));
    uint64_t offset = 0;
    for (size_t row = 0; row < sizes_.size(); ++row) {
      std::vector<std::byte> padded(longest_);
      const auto size = static_cast<uint64_t>(sizes_[row]);
      ENGRAM_RETURN_IF_ERROR(images.read_at(offset, std::span(padded).first(size)));
      ENGRAM_RETURN_IF_ERROR(file_.write_array_rows(path_, row, padded));
      offset += size;
    }
    return file_.finish_array(path_);
  }

 private:
  h5::File& file_;
  std::string path_;
  const Column& column_;
  std::shared_ptr<const ltm::Codec> codec_;
  File waiting_;
  std::vector<float>& sizes_;
  uint64_t longest_ = 1;
};

}  // namespace

bool is_image(const Column& column) {
  const auto& shape = column.form.shape;
  return column.form.element == h5::Element{} && shape.size() == 3 &&
         (shape[2] == 1 || shape[2] == 3) && shape[0] > 0 && shape[1] > 0;
}

Result<std::unique_ptr<RowSink>> make_jpeg_sink(h5::File& file, const std::string& path,
                                                const Column& column, int quality,
                                                std::vector<float>& sizes) {
  ENGRAM_ASSIGN_OR_RETURN(auto codec, ltm::make_codec(fmt::format("jpeg:quality={}", quality)));
  std::filesystem::path beside = file.path();
  beside += ".images";
  ENGRAM_RETURN_IF_ERROR(remove_file(beside));
  ENGRAM_ASSIGN_OR_RETURN(File waiting, File::open(beside, File::Mode::kCreate));
  return std::unique_ptr<RowSink>(
      std::make_unique<JpegSink>(file, path, column, std::move(codec), std::move(waiting), sizes));
}

}  // namespace engram::datasets
