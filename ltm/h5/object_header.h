// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/h5: what an object says of itself, read without HDF5, which trusts sizes in it.

#include <optional>
#include <string>
#include <string_view>

#include "ltm/h5/raw_file.h"

namespace engram::h5 {

/// One message of an object header.
struct HeaderMessage {
  uint16_t type = 0;
  bool is_shared = false;  ///< It only says where the message is.
  RawBytes body;
};

/// All messages of the object header at `offset`.
/// Errors: kDataLoss naming the offset.
/// Source: HDF5 file format specification 3.0, section IV.A.1.
Result<std::vector<HeaderMessage>> read_object_header(const RawFile& file, uint64_t offset);

/// Whether chunks and compact data of a dataset have the sizes that its shape and type need.
/// Errors: kDataLoss naming what does not fit.
Status check_dataset(const std::vector<HeaderMessage>& header);

/// Name and value of an attribute message; nothing for others.
struct HeaderAttribute {
  std::string_view name;
  RawView value;
};
[[nodiscard]] std::optional<HeaderAttribute> header_attribute(const HeaderMessage& message);

/// Whether HDF5 would read beyond an attribute.
[[nodiscard]] bool has_broken_attributes(const std::vector<HeaderMessage>& header);

/// Whether attributes lie outside of the header.
[[nodiscard]] bool has_outer_attributes(const std::vector<HeaderMessage>& header);

}  // namespace engram::h5
