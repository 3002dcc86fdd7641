// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/ros/message_definition.h"
#include "ltm/core/time.h"
#include "ltm/idf/data.h"

namespace engram::datasets::ros {

/// The memory and core segment of messages of a type.
struct SegmentNames {
  std::string memory;
  std::string segment;

  friend bool operator==(const SegmentNames&, const SegmentNames&) = default;
};

/// Converts messages of one type to values and back.
///
/// A message is a dict of its fields; sensor_msgs/Image and CompressedImage are {"image": uint8
/// [H, W, 3]}, RGB, or [H, W, 1], or {"depth": uint16 or float32 [H, W, 1]}, with the other fields
/// beside it. A message that the form of an image cannot hold stays a dict of fields.
/// Threading: immutable, const-parallel.
/// Source: docs/formats.md, "ROS messages".
class MessageType {
 public:
  /// `type` and `definition` are as for MessageDefinition::parse. Errors: those of parse.
  static Result<MessageType> create(std::string_view type, std::string_view definition,
                                    Serialization serialization);

  /// "sensor_msgs/Image".
  [[nodiscard]] const std::string& name() const { return definition_.root().name; }

  /// Safe on hostile bytes. Errors: kDataLoss naming type, offset, what was found and needed.
  [[nodiscard]] Result<idf::Data> decode(std::span<const std::byte> bytes) const;

  /// `jpeg_quality` is for compressed images: 1 to 100, or 0 for PNG. A header that is missing or
  /// None is written as an empty one.
  /// Errors: kInvalidArgument naming type and path if a value is not of this type.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const idf::Data& value,
                                                      int jpeg_quality = 0) const;

  /// Returns the segment that values of this type belong to; nothing for types that have no segment
  /// of their own. `value`, if not null, is used to distinguish colour from depth.
  [[nodiscard]] std::optional<SegmentNames> segment(const idf::Data* value) const;

  /// Returns an empty header; None if the type has no header.
  [[nodiscard]] idf::Data empty_header() const;

  /// Returns true if encode() changes pixels at this quality.
  [[nodiscard]] bool is_lossy(int jpeg_quality) const { return is_compressed_ && jpeg_quality > 0; }

  /// Returns true if values are pictures whenever the form of an image can hold them.
  [[nodiscard]] bool is_image() const { return is_image_ || is_compressed_; }

 private:
  MessageType(MessageDefinition definition, Serialization serialization);

  MessageDefinition definition_;
  Serialization serialization_;
  bool is_image_;
  bool is_compressed_;
};

/// Returns the stamp of a value's header, or of the first of its transforms; nothing if there is
/// none or it is zero.
[[nodiscard]] std::optional<Time> header_stamp(const idf::Data& value);

}  // namespace engram::datasets::ros
