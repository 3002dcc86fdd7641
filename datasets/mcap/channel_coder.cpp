// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/channel_coder.h"

#include "datasets/mcap/json_values.h"
#include "datasets/ros/suited_type.h"
#include "ltm/core/buffer.h"
#include "ltm/idf/json.h"

namespace engram::datasets::mcap {

ChannelCoder ChannelCoder::create(const ChannelRecord& channel, const SchemaRecord* schema) {
  ChannelCoder coder;
  coder.encoding_ = channel.message_encoding;
  coder.is_own_ = channel.metadata.contains(kEntityKey);
  if (schema != nullptr) coder.schema_name_ = schema->name;
  const bool is_ros1 = channel.message_encoding == "ros1";
  if (channel.message_encoding == "json") {
    coder.form_ = coder.is_own_ ? Form::kOwnJson : Form::kJson;
  } else if (schema != nullptr && (is_ros1 || channel.message_encoding == "cdr") &&
             schema->encoding == (is_ros1 ? "ros1msg" : "ros2msg")) {
    auto type = ros::MessageType::create(
        schema->name, schema->data, is_ros1 ? ros::Serialization::kRos1 : ros::Serialization::kCdr);
    if (type.ok()) {
      coder.form_ = Form::kRos;
      coder.ros_ = *std::move(type);
    } else {
      coder.problem_ = type.status().message();
    }
  }
  return coder;
}

Result<idf::Data> ChannelCoder::decode(std::span<const std::byte> bytes) const {
  if (form_ == Form::kJson) return value_of_json(as_text(bytes));
  if (form_ == Form::kOwnJson) {
    auto value = idf::from_json_text(as_text(bytes));
    return value.ok() ? std::move(value) : data_loss("{}", value.status().message());
  }
  if (form_ == Form::kRos) {
    ENGRAM_ASSIGN_OR_RETURN(idf::Data value, ros_->decode(bytes));
    return is_own_ ? ros::without_header(value) : std::move(value);
  }
  ENGRAM_ASSIGN_OR_RETURN(
      auto array, idf::NdArray::create(idf::ElementType::kUInt8,
                                       {static_cast<int64_t>(bytes.size())}, Buffer::copy(bytes)));
  return idf::Data(
      idf::Dict{{"encoding", encoding_}, {"schema", schema_name_}, {"bytes", std::move(array)}});
}

Result<std::vector<std::byte>> ChannelCoder::encode(const idf::Data& value,
                                                    int jpeg_quality) const {
  if (form_ == Form::kRos)
    return is_own_ ? ros::encode_bare(*ros_, value, jpeg_quality)
                   : ros_->encode(value, jpeg_quality);
  if (form_ == Form::kJson || form_ == Form::kOwnJson) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string text,
                            form_ == Form::kJson ? json_of_value(value) : idf::to_json_text(value));
    const auto bytes = as_bytes(text);
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  }
  const idf::Data* bytes = value.at("bytes");
  if (bytes == nullptr || !bytes->is<idf::NdArray>())
    return invalid_argument("is {}, needs a dict with 'bytes' of encoding '{}'", value.kind_name(),
                            encoding_);
  const auto plain = bytes->get<idf::NdArray>().bytes();
  return std::vector<std::byte>(plain.begin(), plain.end());
}

}  // namespace engram::datasets::mcap
