// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/h5.h"

#include <numeric>
#include <thread>

#include "ltm/core/file.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::h5 {
namespace {

using Bytes = std::vector<std::byte>;

/// Datasets, strings and attributes as they were written, to compare with what is read.
struct Content {
  struct Dataset {
    std::string path;
    Type type;
    std::vector<uint64_t> shape;
    Bytes bytes;
  };
  std::vector<Dataset> datasets;
  std::vector<std::string> strings{"", "plain", "größe", "机器人", std::string(300, 'x')};
};

Content example_content(uint64_t rows) {
  RandomValues random(25);
  Content content;
  for (int type = 0; type <= static_cast<int>(Type::kFloat64); ++type)
    for (const char* storage : {"contiguous", "compressed"})
      for (const std::vector<uint64_t>& shape :
           {std::vector<uint64_t>{rows}, {rows, 3}, {0}, {0, 4}, {2, 0, 2}, {}}) {
        uint64_t size = size_bytes(static_cast<Type>(type));
        for (const uint64_t axis : shape) size *= axis;
        Bytes bytes(size);
        for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits() & 3);
        content.datasets.push_back(
            {fmt::format("/{}/t{}/d{}", storage, type, content.datasets.size()),
             static_cast<Type>(type), shape, std::move(bytes)});
      }
  return content;
}

Status write(const std::filesystem::path& path, const Content& content) {
  ENGRAM_ASSIGN_OR_RETURN(File file, File::create(path));
  for (const auto& dataset : content.datasets)
    ENGRAM_RETURN_IF_ERROR(file.write(
        dataset.path, dataset.type, dataset.shape, dataset.bytes,
        dataset.path.starts_with("/compressed") ? Storage::kCompressed : Storage::kContiguous));
  ENGRAM_RETURN_IF_ERROR(file.write_strings("/strings", content.strings));
  ENGRAM_RETURN_IF_ERROR(file.write_strings("/no strings", {}));
  ENGRAM_RETURN_IF_ERROR(file.make_group("/group/inner"));
  ENGRAM_RETURN_IF_ERROR(file.make_group("/group/inner"));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/group", "text", "größe"));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/group", "empty", ""));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/group", "int", int64_t{-5}));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/group", "double", 0.25));
  return file.close();
}

TEST(H5, GivesBackWhatWasWritten) {
  const ScratchDirectory scratch;
  const Content content = example_content(1000);
  ASSERT_OK(write(scratch / "a.h5", content));
  const auto file = File::open(scratch / "a.h5");
  ASSERT_OK(file);
  for (const auto& dataset : content.datasets) {
    const auto info = file->info(dataset.path);
    ASSERT_OK(info);
    EXPECT_EQ(info->type, dataset.type);
    EXPECT_EQ(info->shape, dataset.shape);
    const auto bytes = file->read(dataset.path, dataset.type);
    ASSERT_OK(bytes);
    EXPECT_EQ(*bytes, dataset.bytes) << dataset.path;
  }
  EXPECT_EQ(*file->read_strings("/strings"), content.strings);
  EXPECT_TRUE(file->read_strings("/no strings")->empty());
  EXPECT_EQ(*file->string_attribute("/group", "text"), "größe");
  EXPECT_EQ(*file->string_attribute("/group", "empty"), "");
  EXPECT_EQ(*file->int_attribute("/group", "int"), -5);
  EXPECT_EQ(*file->double_attribute("/group", "double"), 0.25);
  EXPECT_EQ(*file->list("/group"), (std::vector<std::string>{"inner"}));
  EXPECT_EQ(*file->list("/"), (std::vector<std::string>{"compressed", "contiguous", "group",
                                                        "no strings", "strings"}));
  EXPECT_TRUE(*file->exists("/group/inner"));
  EXPECT_FALSE(*file->exists("/group/outer/x"));
}

TEST(H5, ReadsRows) {
  const ScratchDirectory scratch;
  std::vector<int32_t> values(100'000 * 2);
  std::iota(values.begin(), values.end(), 0);
  const std::vector<uint64_t> shape{100'000, 2};
  auto written = File::create(scratch / "a.h5");
  for (const Storage storage : {Storage::kContiguous, Storage::kCompressed})
    ASSERT_OK(written->write(storage == Storage::kContiguous ? "/raw" : "/packed", Type::kInt32,
                             shape, std::as_bytes(std::span(values)), storage));
  ASSERT_OK(written->close());
  const auto file = File::open(scratch / "a.h5");
  for (const char* path : {"/raw", "/packed"}) {
    const auto rows = file->read_rows(path, Type::kInt32, 70'001, 2);
    ASSERT_OK(rows);
    EXPECT_EQ(as_vector<int32_t>(*rows), (std::vector{140'002, 140'003, 140'004, 140'005}));
    EXPECT_TRUE(file->read_rows(path, Type::kInt32, 100'000, 0)->empty());
    EXPECT_FAILS(file->read_rows(path, Type::kInt32, 99'999, 2), StatusCode::kDataLoss, "no rows");
    EXPECT_FAILS(file->read_rows(path, Type::kInt32, 2, UINT64_MAX), StatusCode::kDataLoss,
                 "no rows");
    EXPECT_FAILS(file->read_rows(path, Type::kInt64, 0, 1), StatusCode::kDataLoss, "element type");
  }
  EXPECT_LT(*file->storage_bytes("/packed"), *file->storage_bytes("/raw") / 2);
  EXPECT_EQ(*file->storage_bytes("/raw"), 800'000u);
}

TEST(H5, ContiguousBytesLieAtTheirOffset) {
  const ScratchDirectory scratch;
  const Content content = example_content(100);
  ASSERT_OK(write(scratch / "a.h5", content));
  const auto file = File::open(scratch / "a.h5");
  const auto raw = engram::File::open(scratch / "a.h5", engram::File::Mode::kRead);
  int found = 0;
  for (const auto& dataset : content.datasets) {
    if (!dataset.path.starts_with("/contiguous") || dataset.bytes.empty()) continue;
    const auto info = file->info(dataset.path);
    ASSERT_TRUE(info->offset) << dataset.path;
    Bytes bytes(dataset.bytes.size());
    ASSERT_OK(raw->read_at(*info->offset, bytes));
    EXPECT_EQ(bytes, dataset.bytes);
    ++found;
  }
  EXPECT_EQ(found, 30);
}

TEST(H5, GivesTheSameBytesForTheSameContent) {
  const ScratchDirectory scratch;
  ASSERT_OK(write(scratch / "a.h5", example_content(50)));
  ASSERT_OK(write(scratch / "b.h5", example_content(50)));
  const Buffer a = *read_file(scratch / "a.h5"), b = *read_file(scratch / "b.h5");
  EXPECT_TRUE(std::ranges::equal(a.bytes(), b.bytes()));
}

/// A file with more integers on a group than fit into its header, all but one zero.
Status write_integers(const std::filesystem::path& path, int64_t last) {
  auto file = File::create(path);
  if (!file.ok()) return file.status();
  ENGRAM_RETURN_IF_ERROR(file->make_group("/counts"));
  for (int i = 0; i < 12; ++i)
    ENGRAM_RETURN_IF_ERROR(
        file->write_attribute("/counts", fmt::format("count{}", i), i == 11 ? last : 0));
  ENGRAM_RETURN_IF_ERROR(file->write_attribute("/counts", "text", std::string_view("none")));
  return file->close();
}

TEST(H5, ReplacesAnIntegerAsIfItHadBeenWrittenSo) {
  const ScratchDirectory scratch;
  ASSERT_OK(write_integers(scratch / "changed.h5", 0));
  ASSERT_OK(write_integers(scratch / "written.h5", -123456789012345));
  auto file = File::change(scratch / "changed.h5");
  ASSERT_OK(file.status());
  ASSERT_OK(file->replace_attribute("/counts", "count11", -123456789012345));
  ASSERT_OK(file->close());
  const Buffer a = *read_file(scratch / "changed.h5"), b = *read_file(scratch / "written.h5");
  EXPECT_TRUE(std::ranges::equal(a.bytes(), b.bytes()));
}

TEST(H5, RefusesToReplaceWhatIsNoIntegerThatIsThere) {
  const ScratchDirectory scratch;
  EXPECT_FAILS(File::change(scratch / "none.h5"), StatusCode::kNotFound, "none.h5");
  ASSERT_OK(write_integers(scratch / "a.h5", 0));
  auto file = File::change(scratch / "a.h5");
  ASSERT_OK(file.status());
  EXPECT_FAILS(file->replace_attribute("/none", "count0", 1), StatusCode::kNotFound, "'/none'");
  EXPECT_FAILS(file->replace_attribute("/counts", "more", 1), StatusCode::kNotFound, "'more'");
  EXPECT_FAILS(file->replace_attribute("/counts", "text", 1), StatusCode::kDataLoss,
               "not one integer");
}

TEST(H5, NamesWhatIsMissingOrOfAnotherKind) {
  const ScratchDirectory scratch;
  ASSERT_OK(write(scratch / "a.h5", example_content(5)));
  const auto file = File::open(scratch / "a.h5");
  EXPECT_FAILS(file->info("/x/y"), StatusCode::kNotFound, "'/x/y'");
  EXPECT_FAILS(file->read("/x", Type::kInt8), StatusCode::kNotFound, "a.h5");
  EXPECT_FAILS(file->list("/x"), StatusCode::kNotFound, "'/x'");
  EXPECT_FAILS(file->list("/strings"), StatusCode::kDataLoss, "cannot be listed");
  EXPECT_FAILS(file->read("/group", Type::kInt8), StatusCode::kDataLoss, "no dataset");
  EXPECT_FAILS(file->info("/strings"), StatusCode::kDataLoss, "no plain number");
  EXPECT_FAILS(file->read_strings("/contiguous/t0/d0"), StatusCode::kDataLoss,
               "no list of strings");
  EXPECT_FAILS(file->read("/contiguous/t0/d0", Type::kUInt8), StatusCode::kDataLoss,
               "element type");
  EXPECT_FAILS(file->read("/contiguous/t0/d0", Type::kInt8, 4), StatusCode::kDataLoss, "at most 4");
  EXPECT_FAILS(file->string_attribute("/group", "none"), StatusCode::kNotFound, "'none'");
  EXPECT_FAILS(file->string_attribute("/group", "int"), StatusCode::kDataLoss, "no string");
  EXPECT_FAILS(file->int_attribute("/group", "double"), StatusCode::kDataLoss, "not one number");
  EXPECT_FAILS(file->storage_bytes("/x"), StatusCode::kNotFound, "'/x'");
}

TEST(H5, PrintsNothingInWhicheverThreadItFails) {
  const ScratchDirectory scratch;
  ASSERT_OK(write(scratch / "a.h5", example_content(5)));
  const auto file = File::open(scratch / "a.h5");
  ::testing::internal::CaptureStderr();
  std::thread([&] { EXPECT_FALSE(file->info("/x/y").ok()); }).join();
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(H5, TellsGroupsFromDatasets) {
  const ScratchDirectory scratch;
  auto file = *File::create(scratch / "f.h5");
  ASSERT_OK(file.make_group("/group/inner"));
  const uint64_t count = 1;
  ASSERT_OK(file.write("/group/data", Type::kUInt8, {&count, 1}, std::vector<std::byte>(1),
                       Storage::kCompressed));
  EXPECT_TRUE(*file.is_group("/group"));
  EXPECT_TRUE(*file.is_group("/group/inner"));
  EXPECT_FALSE(*file.is_group("/group/data"));
  EXPECT_FAILS(file.is_group("/group/other"), StatusCode::kNotFound, "other");
}

TEST(H5, RefusesWhatItCannotWriteOrOpen) {
  const ScratchDirectory scratch;
  EXPECT_FAILS(File::open(scratch / "none.h5"), StatusCode::kNotFound, "none.h5");
  ASSERT_OK(replace_file(scratch / "text.h5", as_bytes("this is text")));
  EXPECT_FAILS(File::open(scratch / "text.h5"), StatusCode::kDataLoss, "text.h5");
  EXPECT_FAILS(File::create(scratch / "text.h5"), StatusCode::kAlreadyExists, "text.h5");
  EXPECT_FAILS(File::create(scratch / "no/a.h5"), StatusCode::kUnavailable, "no/a.h5");
  auto file = File::create(scratch / "a.h5");
  const std::vector<std::string> zero{std::string("a\0b", 3)};
  EXPECT_FAILS(file->write_strings("/s", zero), StatusCode::kInvalidArgument, "zero byte");
}

/// Reads everything that can be read. Equal or an error; never a crash.
void read_damaged(const std::filesystem::path& path, const Content& content) {
  const auto file = File::open(path);
  if (!file.ok()) return;
  for (const auto& dataset : content.datasets) {
    const auto bytes = file->read(dataset.path, dataset.type, 1 << 20);
    const bool has_checksum = dataset.path.starts_with("/compressed");
    if (bytes.ok() && has_checksum) {
      EXPECT_EQ(*bytes, dataset.bytes) << dataset.path;
    }
  }
  const auto strings = file->read_strings("/strings");
  if (strings.ok()) {
    EXPECT_EQ(*strings, content.strings);
  }
  const auto text = file->string_attribute("/group", "text");
  if (text.ok()) {
    EXPECT_EQ(*text, "größe");
  }
  (void)file->list("/").ok();
  (void)file->storage_bytes("/").ok();
}

/// Few datasets: the file is small enough to damage all of it.
Content small_content() {
  Content content = example_content(40);
  std::erase_if(content.datasets, [](const auto& dataset) {
    return dataset.type != Type::kFloat64 && dataset.type != Type::kUInt8;
  });
  return content;
}

TEST(H5, SurvivesDamagedFiles) {
  const ScratchDirectory scratch;
  const Content content = small_content();
  ASSERT_OK(write(scratch / "a.h5", content));
  const Buffer whole = *read_file(scratch / "a.h5");
  RandomValues random(26);
  for (size_t at = 0; at < whole.size(); at += 64) {
    Bytes damaged(whole.bytes().begin(), whole.bytes().end());
    damaged[at + random.below(std::min<size_t>(64, whole.size() - at))] ^=
        static_cast<std::byte>(1 + random.below(255));
    overwrite_file(scratch / "d.h5", damaged);
    read_damaged(scratch / "d.h5", content);
  }
}

TEST(H5, SurvivesDamagedStrings) {
  const ScratchDirectory scratch;
  Content content;
  ASSERT_OK(write(scratch / "a.h5", content));
  const Buffer whole = *read_file(scratch / "a.h5");
  for (size_t at = 0; at < whole.size(); ++at)
    for (const int flip : {0x01, 0x80, 0xff}) {
      Bytes damaged(whole.bytes().begin(), whole.bytes().end());
      damaged[at] ^= static_cast<std::byte>(flip);
      overwrite_file(scratch / "d.h5", damaged);
      read_damaged(scratch / "d.h5", content);
    }
}

TEST(H5, SurvivesTruncatedFiles) {
  const ScratchDirectory scratch;
  const Content content = small_content();
  ASSERT_OK(write(scratch / "a.h5", content));
  const Buffer whole = *read_file(scratch / "a.h5");
  for (size_t size = 0; size < whole.size(); size += 101) {
    overwrite_file(scratch / "d.h5", whole.bytes().subspan(0, size));
    EXPECT_FAILS(File::open(scratch / "d.h5"), StatusCode::kDataLoss, "damaged");
  }
}

}  // namespace
}  // namespace engram::h5
