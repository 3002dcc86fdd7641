// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/h5_array.h"

#include <algorithm>

#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::h5 {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

template <typename T>
Bytes bytes_of(std::vector<T> values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

struct NamedArray {
  std::string path;
  ArrayInfo info;
  Bytes rows;
};

std::vector<NamedArray> example_arrays() {
  std::vector<NamedArray> arrays;
  for (int type = 0; type <= static_cast<int>(Type::kFloat64); ++type) {
    const ArrayInfo info{{Kind::kNumber, static_cast<Type>(type)}, {5, 2}, type % 3u, type % 2};
    Bytes rows(5 * info.row_bytes());
    for (size_t i = 0; i < rows.size(); ++i) rows[i] = std::byte(i % 7);
    arrays.push_back({fmt::format("/numbers/t{}", type), info, std::move(rows)});
  }
  arrays.push_back(
      {"/half", {{Kind::kHalf, Type::kFloat32}, {3}}, bytes_of<float>({0.5f, -2, 1024})});
  arrays.push_back({"/bool", {{Kind::kBool}, {3}, 2, 4}, bytes_of<uint8_t>({0, 1, 1})});
  arrays.push_back({"/none", {{Kind::kNumber, Type::kInt64}, {0, 4}}, {}});
  return arrays;
}

const std::vector<std::string> kTexts{"one", "", "größe", std::string(300, 'x')};

std::vector<std::pair<std::string, Attribute>> example_attributes() {
  std::vector<std::pair<std::string, Attribute>> all;
  all.push_back({"bool", {{Kind::kBool}, {}, bytes_of<uint8_t>({1}), {}}});
  all.push_back({"floats", {{Kind::kNumber, Type::kFloat32}, {3}, bytes_of<float>({1, 2, 3}), {}}});
  all.push_back({"text", {{Kind::kText}, {}, {}, {"größe"}}});
  all.push_back({"texts", {{Kind::kText}, {4}, {}, kTexts}});
  all.push_back({"fixed", {{Kind::kFixedText, Type::kUInt8, 4}, {2}, {}, {"ab", "cdef"}}});
  for (int i = 0; i < 10; ++i)
    all.push_back({fmt::format("many {}", i), {{Kind::kText}, {}, {}, {fmt::format("{}", i)}}});
  return all;
}

Status write_example(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(File file, File::create(path, Audience::kEverybody));
  for (const NamedArray& array : example_arrays()) {
    ENGRAM_RETURN_IF_ERROR(file.create_array(array.path, array.info));
    for (uint64_t row = 0; row < array.info.rows(); ++row)
      ENGRAM_RETURN_IF_ERROR(file.write_array_rows(
          array.path, row,
          std::span(array.rows).subspan(row * array.info.row_bytes(), array.info.row_bytes())));
    ENGRAM_RETURN_IF_ERROR(file.finish_array(array.path));
  }
  for (const auto& [name, kind, chunk] : {std::tuple("/fixed", Kind::kFixedText, 0u),
                                          {"/texts", Kind::kText, 0u},
                                          {"/chunked texts", Kind::kText, 3u},
                                          {"/bytes", Kind::kBytes, 0u}}) {
    ENGRAM_RETURN_IF_ERROR(
        file.create_array(name, {{kind, Type::kUInt8, 300}, {kTexts.size()}, chunk}));
    ENGRAM_RETURN_IF_ERROR(file.write_array_texts(name, 0, kTexts));
  }
  ENGRAM_RETURN_IF_ERROR(file.make_group("/group"));
  for (const auto& [name, value] : example_attributes())
    ENGRAM_RETURN_IF_ERROR(file.write_attribute("/group", name, value));
  return file.close();
}

/// Reads everything that a file says to have; errors are fine, crashes are not.
void read_everything(const File& file, const std::string& group, int depth) {
  const auto names = file.list(group);
  if (!names.ok() || depth > 4) return;
  for (const std::string& name : *names) {
    const std::string path = (group == "/" ? "" : group) + "/" + name;
    if (const auto attributes = file.attribute_names(path); attributes.ok())
      for (const std::string& attribute : *attributes) (void)file.attribute(path, attribute);
    if (file.is_group(path).value_or(false)) {
      read_everything(file, path, depth + 1);
      continue;
    }
    const auto info = file.array_info(path);
    if (!info.ok()) continue;
    (void)file.read_array_rows(path, 0, std::min<uint64_t>(info->rows(), 64), 1 << 20);
    (void)file.read_array_texts(path, 0, std::min<uint64_t>(info->rows(), 64));
  }
}

TEST(H5Array, ReadsWhatItWrote) {
  const ScratchDirectory scratch;
  ASSERT_OK(write_example(scratch / "a.h5"));
  const auto file = File::open(scratch / "a.h5");
  ASSERT_OK(file);
  for (const NamedArray& array : example_arrays()) {
    const auto info = file->array_info(array.path);
    ASSERT_OK(info);
    EXPECT_EQ(info->element, array.info.element) << array.path;
    EXPECT_EQ(info->shape, array.info.shape);
    EXPECT_EQ(info->deflate_level, array.info.deflate_level);
    const auto rows = file->read_array_rows(array.path, 0, array.info.rows());
    ASSERT_OK(rows);
    EXPECT_EQ(*rows, array.rows) << array.path;
  }
  for (const char* name : {"/fixed", "/texts", "/chunked texts", "/bytes"}) {
    const auto texts = file->read_array_texts(name, 0, kTexts.size());
    ASSERT_OK(texts);
    EXPECT_EQ(*texts, kTexts) << name;
  }
  EXPECT_THAT(*file->read_array_texts("/chunked texts", 1, 2), ElementsAre("", "größe"));
}

TEST(H5Array, KeepsAttributesOfAllKinds) {
  const ScratchDirectory scratch;
  ASSERT_OK(write_example(scratch / "a.h5"));
  const auto file = File::open(scratch / "a.h5");
  ASSERT_OK(file);
  EXPECT_EQ(file->attribute_names("/group")->size(), example_attributes().size());
  for (const auto& [name, value] : example_attributes()) {
    const auto found = file->attribute("/group", name);
    ASSERT_OK(found);
    EXPECT_EQ(*found, value) << name;
  }
}

TEST(H5Array, UnpacksChunksAsHdf5Does) {
  const ScratchDirectory scratch;
  const std::vector<uint64_t> shape{1000, 7, 9};
  for (int type = 0; type <= static_cast<int>(Type::kFloat64); ++type) {
    const auto path = scratch / fmt::format("{}.h5", type);
    Bytes rows(1000 * 7 * 9 * size_bytes(static_cast<Type>(type)));
    for (size_t i = 0; i < rows.size(); ++i) rows[i] = std::byte(i * i % 251);
    {
      auto file = File::create(path);
      ASSERT_OK(file);
      ASSERT_OK(file->write("/a", static_cast<Type>(type), shape, rows, Storage::kCompressed));
      ASSERT_OK(file->close());
    }
    const auto file = File::open(path);
    ASSERT_OK(file);
    const size_t row_bytes = rows.size() / 1000;
    for (const auto& [first, count] :
         {std::pair<uint64_t, uint64_t>{0, 1000}, {0, 1}, {999, 1}, {130, 700}}) {
      const auto found = file->read_array_rows("/a", first, count);
      ASSERT_OK(found);
      const auto expected = std::span(rows).subspan(first * row_bytes, count * row_bytes);
      EXPECT_TRUE(std::ranges::equal(*found, expected)) << type << " from " << first;
    }
  }
}

TEST(H5Array, ErrorsNameFileAndObject) {
  const ScratchDirectory scratch;
  ASSERT_OK(write_example(scratch / "a.h5"));
  const auto file = File::open(scratch / "a.h5");
  ASSERT_OK(file);
  EXPECT_FAILS(file->array_info("/nothing"), StatusCode::kNotFound, "a.h5': '/nothing'");
  EXPECT_FAILS(file->read_array_rows("/half", 2, 2), StatusCode::kDataLoss, "no rows 2 to 4");
  EXPECT_FAILS(file->read_array_rows("/half", 0, 3, 4), StatusCode::kDataLoss, "at most 4 fit");
  EXPECT_FAILS(file->read_array_rows("/texts", 0, 1), StatusCode::kDataLoss, "no numbers");
  EXPECT_FAILS(file->read_array_texts("/half", 0, 1), StatusCode::kDataLoss, "no list of texts");
  EXPECT_FAILS(file->attribute("/group", "x"), StatusCode::kNotFound, "no attribute 'x'");
}

TEST(H5Array, ArraysThatAnnounceMoreThanTheyStoreAreRefused) {
  const ScratchDirectory scratch;
  {
    auto file = File::create(scratch / "a.h5", Audience::kEverybody);
    ASSERT_OK(file);
    ASSERT_OK(file->create_array("/a", {{}, {uint64_t{1} << 40}, 1 << 16, 1}));
    ASSERT_OK(file->close());
  }
  const auto file = File::open(scratch / "a.h5");
  ASSERT_OK(file);
  EXPECT_FAILS(file->array_info("/a"), StatusCode::kDataLoss, "only 0 are stored");
}

TEST(H5Array, DamagedFilesAreErrors) {
  const ScratchDirectory scratch;
  ASSERT_OK(write_example(scratch / "a.h5"));
  const auto whole = read_file(scratch / "a.h5");
  ASSERT_OK(whole);
  const Bytes good(whole->bytes().begin(), whole->bytes().end());
  for (size_t at = 0; at < good.size(); at += 61) {
    Bytes bad = good;
    bad[at] ^= std::byte(at % 2 == 0 ? 0xFF : 0x10);
    overwrite_file(scratch / "bad.h5", bad);
    if (const auto file = File::open(scratch / "bad.h5"); file.ok()) read_everything(*file, "/", 0);
  }
  for (size_t size = 0; size < good.size(); size += 499) {
    overwrite_file(scratch / "bad.h5", std::span(good).first(size));
    EXPECT_FALSE(File::open(scratch / "bad.h5").ok());
  }
}

}  // namespace
}  // namespace engram::h5
