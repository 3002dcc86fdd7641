// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/sealed_file.h"

#include <numeric>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets::vault {
namespace {

constexpr size_t kSealedChunk = kPlainChunkBytes + kSealBytes;

class SealedFile : public ::testing::Test {
 protected:
  SealedFile() {
    EXPECT_OK(fill_random(id_));
    path_ = scratch_ / to_text(id_);
  }

  static std::vector<std::byte> plain(size_t size) {
    std::vector<std::byte> bytes(size);
    for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 31 + i / 251);
    return bytes;
  }

  void write(const std::vector<std::byte>& bytes, size_t step = 1000) {
    std::filesystem::remove(path_);
    auto file = SealedFileWriter::create(path_, id_, key_);
    ASSERT_OK(file);
    for (size_t at = 0; at < bytes.size(); at += step)
      ASSERT_OK(file->append(std::span(bytes).subspan(at, std::min(step, bytes.size() - at))));
    ASSERT_OK(file->finish());
    EXPECT_EQ(file->file_bytes(), std::filesystem::file_size(path_));
    const size_t chunks = (bytes.size() + kPlainChunkBytes - 1) / kPlainChunkBytes;
    EXPECT_EQ(file->file_bytes(), 32 + bytes.size() + 16 * chunks);
  }

  /// Reads all that the file has by its size.
  Result<std::vector<std::byte>> read() {
    ENGRAM_ASSIGN_OR_RETURN(auto file, SealedFileReader::open(path_, id_, key_));
    std::vector<std::byte> bytes(file.bytes_left());
    ENGRAM_RETURN_IF_ERROR(file.read(bytes));
    EXPECT_EQ(file.bytes_left(), 0U);
    return bytes;
  }

  std::string file_bytes() { return std::string(as_text(read_file(path_)->bytes())); }
  void put(const std::string& bytes) { EXPECT_OK(replace_file(path_, as_bytes(bytes))); }

  ScratchDirectory scratch_;
  RandomId id_{};
  SecretKey key_ = *SecretKey::random();
  std::filesystem::path path_;
};

TEST_F(SealedFile, GivesBackWhatWasSealed) {
  for (const size_t size : {size_t{1}, size_t{17}, kPlainChunkBytes - 1, kPlainChunkBytes,
                            kPlainChunkBytes + 1, 2 * kPlainChunkBytes, 3 * kPlainChunkBytes + 5}) {
    SCOPED_TRACE(size);
    const auto bytes = plain(size);
    write(bytes, size / 3 + 1);
    const auto found = read();
    ASSERT_OK(found);
    EXPECT_EQ(*found, bytes);
    EXPECT_OK(check_sealed_file(path_, id_));
  }
}

TEST_F(SealedFile, SealsEqualChunksDifferently) {
  // The third one: the last chunk has another nonce than all others anyway.
  write(std::vector<std::byte>(3 * kPlainChunkBytes));
  const std::string bytes = file_bytes();
  EXPECT_NE(bytes.substr(kSealedHeaderBytes, kSealedChunk),
            bytes.substr(kSealedHeaderBytes + kSealedChunk, kSealedChunk));
}

TEST_F(SealedFile, FindsFlippedBytes) {
  write(plain(2 * kPlainChunkBytes + 100));
  const std::string whole = file_bytes();
  // All of the header, all around the seals, and a sample of the rest.
  for (size_t at = 0; at < whole.size(); ++at) {
    const size_t in_chunk = at < kSealedHeaderBytes ? 0 : (at - kSealedHeaderBytes) % kSealedChunk;
    if (at >= 64 && in_chunk > 2 && in_chunk < kPlainChunkBytes - 2 && at % 997 != 0) continue;
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    put(bytes);
    EXPECT_EQ(read().status().code(), StatusCode::kDataLoss) << at;
  }
}

TEST_F(SealedFile, FindsChunksThatWereMoved) {
  write(plain(4 * kPlainChunkBytes));
  const std::string whole = file_bytes();
  const auto chunk = [&whole](size_t i) {
    return whole.substr(kSealedHeaderBytes + i * kSealedChunk, kSealedChunk);
  };
  const std::string header = whole.substr(0, kSealedHeaderBytes);
  for (const auto& order : std::vector<std::vector<size_t>>{{1, 0, 2, 3},
                                                            {0, 0, 2, 3},
                                                            {0, 1, 3, 2},
                                                            {0, 1, 3},
                                                            {0, 1, 2},
                                                            {1, 2, 3},
                                                            {3},
                                                            {0},
                                                            {0, 1, 2, 3, 3},
                                                            {0, 1, 2, 2, 3}}) {
    std::string bytes = header;
    for (const size_t i : order) bytes += chunk(i);
    put(bytes);
    EXPECT_EQ(read().status().code(), StatusCode::kDataLoss) << order.size();
  }
  put(whole);
  EXPECT_OK(read());
}

TEST_F(SealedFile, FindsTheChunkOfAnotherFileOfTheSameKey) {
  write(plain(2 * kPlainChunkBytes));
  const std::string first = file_bytes();
  const RandomId first_id = id_;
  EXPECT_OK(fill_random(id_));
  write(plain(2 * kPlainChunkBytes));
  const std::string second = file_bytes();
  put(second.substr(0, kSealedHeaderBytes) + first.substr(kSealedHeaderBytes));
  EXPECT_FAILS(read(), StatusCode::kDataLoss, "seal of chunk 0");
  put(first);
  EXPECT_FAILS(read(), StatusCode::kDataLoss, "another file");
  EXPECT_NE(first_id, id_);
}

TEST_F(SealedFile, AnotherKeyReadsNothing) {
  write(plain(100));
  key_ = *SecretKey::random();
  EXPECT_FAILS(read(), StatusCode::kDataLoss, "seal of chunk 0");
}

TEST_F(SealedFile, IsCutOffNowhere) {
  write(plain(kPlainChunkBytes + 1000));
  const std::string whole = file_bytes();
  for (size_t size = 0; size < whole.size(); size += size < 200 ? 1 : 499) {
    put(whole.substr(0, size));
    EXPECT_EQ(read().status().code(), StatusCode::kDataLoss) << size;
  }
}

TEST_F(SealedFile, TellsAVersionThatItDoesNotKnow) {
  write(plain(100));
  std::string bytes = file_bytes();
  bytes[8] = 2;
  put(bytes);
  EXPECT_FAILS(read(), StatusCode::kDataLoss, "has version 2 of the format, needs 1");
}

TEST_F(SealedFile, WritesOverNoOtherFile) {
  write(plain(10));
  EXPECT_EQ(SealedFileWriter::create(path_, id_, key_).status().code(), StatusCode::kAlreadyExists);
}

}  // namespace
}  // namespace engram::datasets::vault
