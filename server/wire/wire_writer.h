// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/buffer.h"

namespace engram::server {

/// Part of a message in protobuf's wire format, in pieces shared with every message that sends
/// them.
struct WireBytes {
  std::vector<grpc::Slice> pieces;
  size_t size = 0;

  /// Returns a buffer to send, which shares the pieces.
  [[nodiscard]] grpc::ByteBuffer to_byte_buffer() const {
    return grpc::ByteBuffer(pieces.data(), pieces.size());
  }
};

/// Writes protobuf's wire format field by field. Large bytes are shared, not copied.
///
/// Threading: one thread.
class WireWriter {
 public:
  /// Bytes of at least this size are shared: a piece of its own costs about as much as copying
  /// them.
  static constexpr size_t kSharedBytes = 4096;

  /// Appends bytes that protobuf serialized.
  void append(std::string_view bytes) { text_ += bytes; }
  /// Writes the header of a length-delimited field, whose content follows; field() writes both.
  void header(int field, size_t length);
  void field(int field, const Buffer& bytes);
  void field(int field, std::string_view bytes);
  void field(int field, const WireBytes& bytes);
  void field(int field, uint64_t number);

  [[nodiscard]] size_t size() const { return size_ + text_.size(); }
  [[nodiscard]] WireBytes take();

  /// The size that field() writes for `length` bytes.
  [[nodiscard]] static size_t field_size(int field, size_t length);

 private:
  void varint(uint64_t number);
  void end_piece();

  std::string text_;
  std::vector<grpc::Slice> pieces_;
  size_t size_ = 0;  ///< Total size of the pieces.
};

}  // namespace engram::server
