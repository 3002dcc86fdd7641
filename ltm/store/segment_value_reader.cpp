// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_value_reader.h"

#include <algorithm>

#include "ltm/codec/zstd.h"
#include "ltm/idf/binary.h"
#include "ltm/store/segment_format.h"

namespace engram::ltm {

namespace {

constexpr size_t kMaxRemainderBytes = size_t{1} << 31;
constexpr uint64_t kMaxDictionary = 1 << 20;
constexpr int kDepth = idf::kMaxDepth + idf::kContainerDepth;

}  // namespace

Result<idf::Data> SegmentValueReader::value(const std::string& group, uint64_t row) {
  ENGRAM_ASSIGN_OR_RETURN(idf::Data remains, remainder(group + "/remainder", row));
  // A row of another layout is stored whole in its remainder; its cells in the columns have no
  // meaning.
  if (const idf::Data* whole = remains.at("value"); remains.is<idf::Dict>() && whole != nullptr)
    return *whole;
  if (!remains.is<idf::List>())
    return source_.broken(group, fmt::format("row {} has no remainder", row));
  ENGRAM_ASSIGN_OR_RETURN(Tables * tables, tables_of(group));
  ENGRAM_ASSIGN_OR_RETURN(auto arrays, tensors(*tables, row));
  return tables->layout.join({std::move(arrays), remains.get<idf::List>()});
}

Result<idf::Data> SegmentValueReader::remainder(const std::string& group, uint64_t row) {
  ENGRAM_ASSIGN_OR_RETURN(Remainder * remainder, remainder_of(group));
  const uint64_t number = row / remainder->rows_per_block;
  if (remainder->number != number) ENGRAM_RETURN_IF_ERROR(read_block(group, number, *remainder));
  const uint64_t at = row % remainder->rows_per_block;
  if (at >= remainder->rows.size())
    return source_.broken(group, fmt::format("block {} lacks row {}", number, row));
  return remainder->rows[at];
}

Status SegmentValueReader::read_block(const std::string& group, uint64_t number,
                                      Remainder& remainder) {
  // Cleared first, so that a failed read does not leave old rows under a new number.
  remainder.number.reset();
  ENGRAM_ASSIGN_OR_RETURN(const Buffer packed, source_.blob(group, number));
  const auto& common = remainder.dictionary;
  ENGRAM_ASSIGN_OR_RETURN(auto plain, common
                                          ? common->decompress(packed.bytes(), kMaxRemainderBytes)
                                          : decompress_zstd(packed.bytes(), kMaxRemainderBytes));
  ENGRAM_ASSIGN_OR_RETURN(idf::Data block, idf::decode(Buffer::take(std::move(plain)), kDepth));
  if (!block.is<idf::List>())
    return source_.broken(group, fmt::format("block {} is no list", number));
  remainder.rows = std::move(*block.get_if<idf::List>());
  remainder.number = number;
  return {};
}

Result<SegmentValueReader::Remainder*> SegmentValueReader::remainder_of(const std::string& group) {
  if (const auto known = remainders_.find(group); known != remainders_.end()) return &known->second;
  ENGRAM_ASSIGN_OR_RETURN(Remainder opened, open_remainder(group));
  return &remainders_.emplace(group, std::move(opened)).first->second;
}

Result<SegmentValueReader::Remainder> SegmentValueReader::open_remainder(const std::string& group) {
  Remainder opened;
  ENGRAM_ASSIGN_OR_RETURN(const int64_t per_block,
                          source_.file().int_attribute(group, "rows_per_block"));
  if (per_block < 1) return source_.broken(group, "has no rows per block");
  opened.rows_per_block = static_cast<uint64_t>(per_block);
  ENGRAM_ASSIGN_OR_RETURN(const bool has_dictionary, source_.file().exists(group + "/dictionary"));
  if (has_dictionary) {
    ENGRAM_ASSIGN_OR_RETURN(
        auto bytes, source_.file().read(group + "/dictionary", h5::Type::kUInt8, kMaxDictionary));
    ENGRAM_ASSIGN_OR_RETURN(
        opened.dictionary,
        source_.located(ZstdDictionary::from_bytes(Buffer::take(std::move(bytes)))));
  }
  return opened;
}

Result<idf::Layout> SegmentValueReader::layout(const std::string& group) {
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, source_.file().read(group + "/layout", h5::Type::kUInt8));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data data,
                          idf::decode(Buffer::take(std::move(bytes)), kDepth));
  return idf::Layout::from_data(data);
}

Result<SegmentValueReader::Tables*> SegmentValueReader::tables_of(const std::string& group) {
  if (const auto known = tables_.find(group); known != tables_.end()) return &known->second;
  ENGRAM_ASSIGN_OR_RETURN(Tables tables, open_tables(group));
  return &tables_.emplace(group, std::move(tables)).first->second;
}

Result<SegmentValueReader::Tables> SegmentValueReader::open_tables(const std::string& group) {
  Tables tables;
  ENGRAM_ASSIGN_OR_RETURN(tables.layout, layout(group));
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * times, source_.column(group + "/timestamp"));
  std::map<std::string, size_t> matrices;
  for (const idf::TensorMember& member : tables.layout.members()) {
    const size_t size = *idf::size_bytes(member.type, member.shape);
    Table made{group + "/arrays" + segment_member(member.path),
               {member.type, times->rows(), 1, size / idf::size_bytes(member.type)}};
    if (is_scalar(member)) {
      made.path = group + "/columns/" + scalar_group(member) + "/values";
      const auto [known, is_new] = matrices.emplace(made.path, tables.tables.size());
      if (!is_new) {
        const size_t column = tables.tables[known->second].shape.columns++;
        tables.members.push_back({known->second, column * size});
        continue;
      }
    }
    const auto are_blocks = blocks_.has(made.path);
    // The layout names this dataset, so a missing one is damage and not an absent member.
    if (are_blocks.status().code() == StatusCode::kNotFound)
      return source_.broken(made.path, "is missing");
    ENGRAM_ASSIGN_OR_RETURN(made.are_blocks, are_blocks);
    tables.members.push_back({tables.tables.size(), 0});
    tables.tables.push_back(std::move(made));
  }
  return tables;
}

Result<std::set<std::string, std::less<>>> SegmentValueReader::columns(const std::string& group) {
  ENGRAM_ASSIGN_OR_RETURN(const Tables* tables, tables_of(group));
  std::set<std::string, std::less<>> paths;
  for (size_t i = 0; i < tables->members.size(); ++i)
    if (tables->tables[tables->members[i].table].are_blocks)
      paths.insert(tables->layout.members()[i].path);
  return paths;
}

Result<std::vector<idf::NdArray>> SegmentValueReader::tensors(Tables& tables, uint64_t row) {
  std::vector<idf::NdArray> values;
  for (size_t i = 0; i < tables.members.size(); ++i) {
    const idf::TensorMember& member = tables.layout.members()[i];
    const Table& table = tables.tables[tables.members[i].table];
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, row_of(table, row));
    const size_t offset = tables.members[i].offset;
    const size_t size = table.shape.cell_bytes();
    // Layout and dataset are separate objects of the file and may contradict each other.
    if (bytes.size() < offset + size)
      return source_.broken(table.path, "has fewer columns than the layout");
    ENGRAM_ASSIGN_OR_RETURN(
        idf::NdArray array,
        idf::NdArray::create(member.type, member.shape, Buffer::copy(bytes.subspan(offset, size))));
    values.push_back(std::move(array));
  }
  return values;
}

Result<std::span<const std::byte>> SegmentValueReader::row_of(const Table& table, uint64_t row) {
  if (table.are_blocks) return blocks_.row(table.path, table.shape, row);
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * plain, source_.column(table.path));
  if (plain->info().type != h5_type(table.shape.type))
    return source_.broken(table.path, "has another element type than the layout says");
  return plain->row(row);
}

}  // namespace engram::ltm
