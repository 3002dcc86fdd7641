// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/h5: reads object headers without HDF5, which trusts the sizes in them.

#include <optional>
#include <string>
#include <string_view>

#include "ltm/h5/raw_file.h"

namespace engram::h5 {

/// One message of an object header.
struct HeaderMessage {
  uint16_t type = 0;
  bool is_shared = false;  ///< The body only contains the location of the message.
  RawBytes body;
};

/// All messages of the object header at `offset`.
/// Errors: kDataLoss naming the offset.
/// Source: HDF5 file format specification 3.0, section IV.A.1.
Result<std::vector<HeaderMessage>> read_object_header(const RawFile& file, uint64_t offset);

/// Checks that the chunks and compact data of a dataset have the sizes that its shape and type
/// need.
/// Errors: kDataLoss naming the mismatch.
Status check_dataset(const std::vector<HeaderMessage>& header);

/// Name and value of an attribute message.
struct HeaderAttribute {
  std::string_view name;
  RawView value;
};
[[nodiscard]] std::optional<HeaderAttribute> header_attribute(const HeaderMessage& message);

/// True if HDF5 would read beyond the end of an attribute.
[[nodiscard]] bool has_broken_attributes(const std::vector<HeaderMessage>& header);

/// True if attributes are stored outside the header.
[[nodiscard]] bool has_outer_attributes(const std::vector<HeaderMessage>& header);

}  // namespace engram::h5
