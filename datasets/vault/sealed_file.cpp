// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/sealed_file.h"

#include <openssl/evp.h>

#include <algorithm>

#include "ltm/core/byte_fields.h"
#include "ltm/core/printable.h"

namespace engram::datasets::vault {

namespace {

constexpr std::string_view kDayMagic = "ENGRAMVD";
constexpr uint32_t kDayVersion = 1;
constexpr size_t kFileChunkBytes = kPlainChunkBytes + kSealBytes;
constexpr size_t kNonceBytes = 12;

using Header = std::array<std::byte, kSealedHeaderBytes>;

Header header_of(const RandomId& id) {
  std::vector<std::byte> bytes;
  FieldWriter out(bytes);
  out.bytes(as_bytes(kDayMagic));
  out.number(kDayVersion);
  out.number(static_cast<uint32_t>(kPlainChunkBytes));
  out.bytes(id);
  Header header{};
  std::ranges::copy(bytes, header.begin());
  return header;
}

const unsigned char* raw(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

unsigned char* raw(std::span<std::byte> bytes) {
  return reinterpret_cast<unsigned char*>(bytes.data());
}

/// Encrypts or decrypts the chunks of one file. OpenSSL fails here only without memory, or where a
/// seal does not fit.
class ChunkCipher {
 public:
  ChunkCipher(const SecretKey& key, const RandomId& id, bool seals)
      : header_(header_of(id)), seals_(seals), context_(EVP_CIPHER_CTX_new()) {
    is_ready_ =
        context_ != nullptr && EVP_CipherInit_ex(context_.get(), EVP_aes_256_gcm(), nullptr,
                                                 raw(key.bytes()), nullptr, seals ? 1 : 0) == 1;
  }

  [[nodiscard]] const Header& header() const { return header_; }

  /// Replaces `chunk` in place. `seal` is written, or compared with.
  [[nodiscard]] bool run(uint64_t number, bool is_last, std::span<std::byte> chunk,
                         std::span<std::byte, kSealBytes> seal) {
    const auto nonce = nonce_of(number, is_last);
    int count = 0;
    if (!is_ready_ || EVP_CipherInit_ex(context_.get(), nullptr, nullptr, nullptr, raw(nonce),
                                        seals_ ? 1 : 0) != 1)
      return false;
    for (const std::span<const std::byte> bound :
         {std::span<const std::byte>(header_), std::span<const std::byte>(nonce)})
      if (EVP_CipherUpdate(context_.get(), nullptr, &count, raw(bound),
                           static_cast<int>(bound.size())) != 1)
        return false;
    if (EVP_CipherUpdate(context_.get(), raw(chunk), &count, raw(chunk),
                         static_cast<int>(chunk.size())) != 1)
      return false;
    if (!seals_ && !control(EVP_CTRL_GCM_SET_TAG, seal)) return false;
    std::array<unsigned char, kSealBytes> none{};
    if (EVP_CipherFinal_ex(context_.get(), none.data(), &count) != 1) return false;
    return !seals_ || control(EVP_CTRL_GCM_GET_TAG, seal);
  }

 private:
  struct Free {
    void operator()(EVP_CIPHER_CTX* context) const { EVP_CIPHER_CTX_free(context); }
  };

  /// No two chunks of a file have one nonce, and a key has one file.
  static std::array<std::byte, kNonceBytes> nonce_of(uint64_t number, bool is_last) {
    std::array<std::byte, kNonceBytes> nonce{};
    std::memcpy(nonce.data(), &number, sizeof(number));
    nonce[sizeof(number)] = is_last ? std::byte{1} : std::byte{0};
    return nonce;
  }

  bool control(int what, std::span<std::byte, kSealBytes> seal) {
    return EVP_CIPHER_CTX_ctrl(context_.get(), what, static_cast<int>(kSealBytes), seal.data()) ==
           1;
  }

  Header header_;
  bool seals_;
  std::unique_ptr<EVP_CIPHER_CTX, Free> context_;
  bool is_ready_ = false;
};

/// The size of the file without its header must be that of whole chunks and a last one that is not
/// empty.
bool is_possible_size(uint64_t file_bytes) {
  if (file_bytes <= kSealedHeaderBytes + kSealBytes) return false;
  const uint64_t last = (file_bytes - kSealedHeaderBytes) % kFileChunkBytes;
  return last == 0 || last > kSealBytes;
}

Status check_sealed_head(const File& file, uint64_t size, const RandomId& id) {
  const auto wrong = [&file](std::string_view what) {
    return data_loss("'{}': {}", printable(file.path().string()), what);
  };
  if (!is_possible_size(size)) return wrong("is cut off, or was added to");
  Header found{};
  ENGRAM_RETURN_IF_ERROR(file.read_at(0, found));
  FieldReader in(found);
  if (as_text(in.bytes(kDayMagic.size())) != kDayMagic) return wrong("is no file of a vault");
  const auto version = in.number<uint32_t>();
  if (version != kDayVersion)
    return wrong(fmt::format("has version {} of the format, needs {}", version, kDayVersion));
  if (found != header_of(id)) return wrong("is another file than its name says");
  return {};
}

uint64_t chunk_count(uint64_t file_bytes) {
  return (file_bytes - kSealedHeaderBytes + kFileChunkBytes - 1) / kFileChunkBytes;
}

}  // namespace

std::string to_text(const RandomId& id) {
  std::string text;
  for (const std::byte byte : id) text += fmt::format("{:02x}", std::to_integer<unsigned>(byte));
  return text;
}

struct SealedFileWriter::State {
  File file;
  ChunkCipher cipher;
  uint64_t number = 0;  ///< Of the chunk that is being filled.
  size_t used = 0;
  std::vector<std::byte> chunk;
  uint64_t file_bytes = kSealedHeaderBytes;

  Status seal(bool is_last) {
    const std::span<std::byte> all(chunk);
    if (!cipher.run(number, is_last, all.first(used), all.subspan(used).first<kSealBytes>()))
      return unavailable("'{}': OpenSSL cannot encrypt", printable(file.path().string()));
    ENGRAM_RETURN_IF_ERROR(file.append(all.first(used + kSealBytes)));
    file_bytes += used + kSealBytes;
    ++number;
    used = 0;
    return {};
  }
};

SealedFileWriter::SealedFileWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
SealedFileWriter::SealedFileWriter(SealedFileWriter&&) noexcept = default;
SealedFileWriter::~SealedFileWriter() = default;

Result<SealedFileWriter> SealedFileWriter::create(const std::filesystem::path& path,
                                                  const RandomId& id, const SecretKey& key) {
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kCreate));
  auto state =
      std::make_unique<State>(State{std::move(file), ChunkCipher(key, id, true), 0, 0, {}});
  state->chunk.resize(kFileChunkBytes);
  ENGRAM_RETURN_IF_ERROR(state->file.append(state->cipher.header()));
  return SealedFileWriter(std::move(state));
}

Status SealedFileWriter::append(std::span<const std::byte> bytes) {
  State& state = *state_;
  while (!bytes.empty()) {
    // A full chunk waits until more comes: only then it is not the last one.
    if (state.used == kPlainChunkBytes) ENGRAM_RETURN_IF_ERROR(state.seal(false));
    const size_t count = std::min(bytes.size(), kPlainChunkBytes - state.used);
    std::memcpy(state.chunk.data() + state.used, bytes.data(), count);
    state.used += count;
    bytes = bytes.subspan(count);
  }
  return {};
}

Status SealedFileWriter::finish() {
  ENGRAM_CHECK(state_->used > 0, "a sealed file without content");
  return state_->seal(true);
}

uint64_t SealedFileWriter::file_bytes() const {
  return state_->file_bytes;
}

struct SealedFileReader::State {
  File file;
  ChunkCipher cipher;
  uint64_t file_bytes = 0;
  uint64_t chunks = 0;
  uint64_t next = 0;  ///< The chunk to read next.
  std::vector<std::byte> chunk;
  std::span<const std::byte> left{};  ///< Of the chunk that was read.

  [[nodiscard]] uint64_t offset(uint64_t number) const {
    return kSealedHeaderBytes + number * kFileChunkBytes;
  }

  Status open_next() {
    const uint64_t at = offset(next);
    if (next == chunks)
      return data_loss("'{}': ends at byte {}, needs more", printable(file.path().string()), at);
    const bool is_last = next + 1 == chunks;
    const auto size =
        static_cast<size_t>(is_last ? file_bytes - at : static_cast<uint64_t>(kFileChunkBytes));
    const std::span<std::byte> all = std::span(chunk).first(size);
    ENGRAM_RETURN_IF_ERROR(file.read_at(at, all));
    const auto content = all.first(size - kSealBytes);
    if (!cipher.run(next, is_last, content, all.last<kSealBytes>()))
      return data_loss(
          "'{}': the seal of chunk {} at byte {} does not fit: it was changed, or it is of another "
          "key, place or file",
          printable(file.path().string()), next, at);
    ++next;
    left = content;
    return {};
  }
};

SealedFileReader::SealedFileReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
SealedFileReader::SealedFileReader(SealedFileReader&&) noexcept = default;
SealedFileReader::~SealedFileReader() = default;

Result<SealedFileReader> SealedFileReader::open(const std::filesystem::path& path,
                                                const RandomId& id, const SecretKey& key) {
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  ENGRAM_RETURN_IF_ERROR(check_sealed_head(file, size, id));
  auto state = std::make_unique<State>(
      State{std::move(file), ChunkCipher(key, id, false), size, chunk_count(size), 0, {}});
  state->chunk.resize(kFileChunkBytes);
  return SealedFileReader(std::move(state));
}

Status SealedFileReader::read(std::span<std::byte> out) {
  State& state = *state_;
  while (!out.empty()) {
    if (state.left.empty()) ENGRAM_RETURN_IF_ERROR(state.open_next());
    const size_t count = std::min(out.size(), state.left.size());
    std::memcpy(out.data(), state.left.data(), count);
    state.left = state.left.subspan(count);
    out = out.subspan(count);
  }
  return {};
}

uint64_t SealedFileReader::bytes_left() const {
  const State& state = *state_;
  if (state.next == state.chunks) return state.left.size();
  const uint64_t file_left = state.file_bytes - state.offset(state.next);
  return state.left.size() + file_left - (state.chunks - state.next) * kSealBytes;
}

Status check_sealed_file(const std::filesystem::path& path, const RandomId& id) {
  ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(path, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  return check_sealed_head(file, size, id);
}

}  // namespace engram::datasets::vault
