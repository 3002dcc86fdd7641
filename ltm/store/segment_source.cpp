// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_source.h"

#include "ltm/store/checksum.h"

namespace engram::ltm {

namespace {

constexpr uint64_t kMaxBlobBytes = uint64_t{1} << 32;

}  // namespace

Status SegmentSource::broken(const std::string& object, std::string_view what) const {
  return data_loss("segment '{}': '{}': {}", raw_.path().string(), object, what);
}

Result<SegmentColumn*> SegmentSource::column_if_there(const std::string& path) {
  auto known = columns_.find(path);
  if (known == columns_.end()) {
    auto opened = SegmentColumn::open(file_, path);
    if (!opened.ok() && opened.status().code() != StatusCode::kNotFound) return opened.status();
    known = columns_.emplace(path, std::nullopt).first;
    if (opened.ok()) known->second = std::move(opened).value();
  }
  return known->second ? &*known->second : nullptr;
}

Result<SegmentColumn*> SegmentSource::column(const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * found, column_if_there(path));
  if (found == nullptr) return broken(path, "is missing");
  return found;
}

Result<const std::vector<std::string>*> SegmentSource::strings(const std::string& path) {
  const auto known = string_lists_.find(path);
  if (known != string_lists_.end()) return &known->second;
  ENGRAM_ASSIGN_OR_RETURN(auto values, file_.read_strings(path));
  return &string_lists_.emplace(path, std::move(values)).first->second;
}

Result<Buffer> SegmentSource::blob(const std::string& group, uint64_t index) {
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t begin, number<uint64_t>(group + "/offset", index));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t end, number<uint64_t>(group + "/offset", index + 1));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t expected, number<uint64_t>(group + "/checksum", index));
  if (begin == end) return Buffer();
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * bytes, column(group + "/bytes"));
  if (end < begin || end > bytes->rows() || end - begin > kMaxBlobBytes || !bytes->info().offset ||
      bytes->info().type != h5::Type::kUInt8)
    return broken(group, fmt::format("row {} has no valid offsets", index));
  std::vector<std::byte> content(end - begin);
  ENGRAM_RETURN_IF_ERROR(raw_.read_at(*bytes->info().offset + begin, content));
  if (checksum(content) != expected)
    return broken(group, fmt::format("row {} fails its checksum", index));
  return Buffer::take(std::move(content));
}

}  // namespace engram::ltm
