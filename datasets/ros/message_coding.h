// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstddef>
#include <span>
#include <vector>

#include "datasets/ros/message_definition.h"
#include "ltm/idf/data.h"

namespace engram::datasets::ros {

/// The bytes of the header of CDR, which name the byte order.
inline constexpr size_t kEncapsulationBytes = 4;

/// Decodes a message to a dict of its fields.
///
/// int8 to int32 and uint16 become int32; uint32 and int64 become int64; uint64 becomes an ndarray
/// of one element; arrays of numbers become ndarrays, of bool as uint8; all others become lists.
/// Text that is not UTF-8 becomes an ndarray of bytes. A time of ROS 1 is {"sec", "nsec"}.
/// Errors: kDataLoss naming the offset, what was found and what was needed. Memory: bounded by the
/// number of bytes, whatever lengths they state.
Result<idf::Data> decode_fields(const MessageDefinition& definition, Serialization serialization,
                                std::span<const std::byte> bytes);

/// Encodes a dict of fields. Numbers may be of any kind that holds the same value.
/// Errors: kInvalidArgument naming the path if a member is missing, unknown or does not fit.
Result<std::vector<std::byte>> encode_fields(const MessageDefinition& definition,
                                             Serialization serialization, const idf::Data& value);

/// The element type of an array of plain numbers.
[[nodiscard]] idf::ElementType element_type(FieldKind kind);

}  // namespace engram::datasets::ros
