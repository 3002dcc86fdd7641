// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/connection_coder.h"

#include "datasets/recordings/text_value.h"
#include "ltm/core/buffer.h"

namespace engram::datasets::rosbag {

ConnectionCoder ConnectionCoder::create(const Connection& connection) {
  ConnectionCoder coder;
  coder.type_ = connection.type;
  auto type =
      ros::MessageType::create(connection.type, connection.definition, ros::Serialization::kRos1);
  if (type.ok())
    coder.ros_ = *std::move(type);
  else
    coder.problem_ = type.status().message();
  return coder;
}

Result<idf::Data> ConnectionCoder::decode(std::span<const std::byte> bytes) const {
  if (ros_) return ros_->decode(bytes);
  ENGRAM_ASSIGN_OR_RETURN(
      auto array, idf::NdArray::create(idf::ElementType::kUInt8,
                                       {static_cast<int64_t>(bytes.size())}, Buffer::copy(bytes)));
  return idf::Data(idf::Dict{{"type", text_value(type_)}, {"bytes", std::move(array)}});
}

}  // namespace engram::datasets::rosbag
