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

/// A part of a message in protobuf's wire form, in pieces that are shared with whoever sends them.
struct WireBytes {
  std::vector<grpc::Slice> pieces;
  size_t size = 0;

  /// To be sent: shares the pieces.
  [[nodiscard]] grpc::ByteBuffer to_byte_buffer() const {
    return grpc::ByteBuffer(pieces.data(), pieces.size());
  }
};

/// Writes protobuf's wire form field by field. Large bytes are shared, not copied.
///
/// Threading: one thread.
class WireWriter {
 public:
  /// From here on bytes are shared: a piece of its own costs about as much as copying that.
  static constexpr size_t kSharedBytes = 4096;

  /// A message as protobuf wrote it.
  void append(std::string_view bytes) { text_ += bytes; }
  /// Field of bytes or of a message; its content follows, or is given.
  void header(int field, size_t length);
  void field(int field, const Buffer& bytes);
  void field(int field, std::string_view bytes);
  void field(int field, const WireBytes& bytes);
  void field(int field, uint64_t number);

  [[nodiscard]] size_t size() const { return size_ + text_.size(); }
  [[nodiscard]] WireBytes take();

  /// What field() writes for so many bytes.
  [[nodiscard]] static size_t field_size(int field, size_t length);

 private:
  void varint(uint64_t number);
  void end_piece();

  std::string text_;
  std::vector<grpc::Slice> pieces_;
  size_t size_ = 0;  ///< Of the pieces.
};

}  // namespace engram::server
