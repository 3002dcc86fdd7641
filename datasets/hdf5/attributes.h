// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: attributes of HDF5 objects as values, and back.

#include "datasets/recordings/recording_reader.h"
#include "ltm/h5/h5.h"

namespace engram::datasets {

/// Reads all attributes of an object. Those that cannot be read are counted in `report`.
idf::Dict read_attributes(const h5::File& file, const std::string& object, ReadingReport& report);

/// Writes what read_attributes returned, with texts of variable length. Values of other kinds are
/// left out.
Status write_attributes(h5::File& file, const std::string& object, const idf::Dict& attributes);

}  // namespace engram::datasets
