// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_writer.h"

#include <memory>

namespace engram::server {

namespace {

constexpr uint64_t kVarint = 0;
constexpr uint64_t kLengthDelimited = 2;

size_t varint_size(uint64_t number) {
  size_t size = 1;
  for (; number >= 0x80; number >>= 7) ++size;
  return size;
}

grpc::Slice shared_piece(const Buffer& bytes) {
  // gRPC only reads the bytes, but its interface has no const pointer.
  auto* owner = new Buffer(bytes);
  return {const_cast<std::byte*>(owner->data()), owner->size(),
          [](void* kept) { delete static_cast<Buffer*>(kept); }, owner};
}

}  // namespace

void WireWriter::varint(uint64_t number) {
  for (; number >= 0x80; number >>= 7) text_ += static_cast<char>((number & 0x7f) | 0x80);
  text_ += static_cast<char>(number);
}

void WireWriter::header(int field, size_t length) {
  varint(static_cast<uint64_t>(field) << 3 | kLengthDelimited);
  varint(length);
}

void WireWriter::field(int field, const Buffer& bytes) {
  header(field, bytes.size());
  if (bytes.size() < kSharedBytes) {
    append(as_text(bytes.bytes()));
    return;
  }
  end_piece();
  pieces_.push_back(shared_piece(bytes));
  size_ += bytes.size();
}

void WireWriter::field(int field, std::string_view bytes) {
  header(field, bytes.size());
  append(bytes);
}

void WireWriter::field(int field, const WireBytes& bytes) {
  header(field, bytes.size);
  for (const grpc::Slice& piece : bytes.pieces) {
    if (piece.size() < kSharedBytes) {
      text_.append(reinterpret_cast<const char*>(piece.begin()), piece.size());
      continue;
    }
    end_piece();
    pieces_.push_back(piece);
    size_ += piece.size();
  }
}

void WireWriter::field(int field, uint64_t number) {
  varint(static_cast<uint64_t>(field) << 3 | kVarint);
  varint(number);
}

WireBytes WireWriter::take() {
  end_piece();
  WireBytes taken{std::move(pieces_), size_};
  pieces_.clear();
  size_ = 0;
  return taken;
}

size_t WireWriter::field_size(int field, size_t length) {
  return varint_size(static_cast<uint64_t>(field) << 3) + varint_size(length) + length;
}

void WireWriter::end_piece() {
  if (text_.empty()) return;
  size_ += text_.size();
  pieces_.emplace_back(text_.data(), text_.size());
  text_.clear();
}

}  // namespace engram::server
