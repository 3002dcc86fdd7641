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

/// Memory and core segment that messages belong to.
struct SegmentNames {
  std::string memory;
  std::string segment;

  friend bool operator==(const SegmentNames&, const SegmentNames&) = default;
};

/// Messages of one type as values, both ways.
///
/// A message is a dict of its fields; sensor_msgs/Image and CompressedImage are {"image": uint8
/// [H, W, 3]}, RGB, or [H, W, 1], or {"depth": uint16 or float32 [H, W, 1]}, with the rest beside
/// it. What the form of an image cannot hold stays a dict of fields.
/// Threading: immutable, const-parallel.
/// Source: docs/formats.md, "ROS messages".
class MessageType {
 public:
  /// `type` and `definition` as MessageDefinition::parse takes them. Errors: those of it.
  static Result<MessageType> create(std::string_view type, std::string_view definition,
                                    Serialization serialization);

  /// "sensor_msgs/Image".
  [[nodiscard]] const std::string& name() const { return definition_.root().name; }

  /// Safe on hostile bytes. Errors: kDataLoss naming type, offset, what was found and needed.
  [[nodiscard]] Result<idf::Data> decode(std::span<const std::byte> bytes) const;

  /// `jpeg_quality` is for compressed images: 1 to 100, or 0 for PNG. A header that is missing, or
  /// None, is written empty.
  /// Errors: kInvalidArgument naming type and path where a value is not of this type.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const idf::Data& value,
                                                      int jpeg_quality = 0) const;

  /// Where values of this type belong. `value`, if there is one, tells colour from depth. Nothing
  /// for types that have no place of their own.
  [[nodiscard]] std::optional<SegmentNames> segment(const idf::Data* value) const;

  /// What a header is that says nothing; None where the type has none.
  [[nodiscard]] idf::Data empty_header() const;

  /// Whether encode() changes pixels at this quality.
  [[nodiscard]] bool is_lossy(int jpeg_quality) const { return is_compressed_ && jpeg_quality > 0; }

  /// Whether values are pictures, if they can be.
  [[nodiscard]] bool is_image() const { return is_image_ || is_compressed_; }

 private:
  MessageType(MessageDefinition definition, Serialization serialization);

  MessageDefinition definition_;
  Serialization serialization_;
  bool is_image_;
  bool is_compressed_;
};

/// The stamp of a value's header, or of the first of its transforms; nothing where it has none, or
/// zero.
[[nodiscard]] std::optional<Time> header_stamp(const idf::Data& value);

}  // namespace engram::datasets::ros
