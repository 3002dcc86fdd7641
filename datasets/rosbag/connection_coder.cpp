// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/connection_coder.h"

#include "datasets/recordings/text_value.h"
#include "datasets/ros/message_digest.h"
#include "datasets/ros/standard_definitions.h"
#include "datasets/ros/suited_type.h"
#include "ltm/core/buffer.h"
#include "ltm/idf/json.h"

namespace engram::datasets::rosbag {

namespace {

constexpr std::string_view kTextForm = "text";
constexpr std::string_view kStringForm = "string";
constexpr std::string_view kJsonForm = "json";
constexpr const char* kTextType = "std_msgs/String";

/// Returns null if the value is not just a text under this name.
const std::string* lone_text(const idf::Data& value, std::string_view name) {
  const auto* dict = value.get_if<idf::Dict>();
  const idf::Data* text = dict != nullptr && dict->size() == 1 ? dict->find(name) : nullptr;
  return text == nullptr ? nullptr : text->get_if<std::string>();
}

/// Returns empty text if the value is the message itself.
std::string_view text_form(const idf::Data& value) {
  if (lone_text(value, "data") != nullptr) return "";
  if (lone_text(value, "text") != nullptr) return kTextForm;
  return value.is<std::string>() ? kStringForm : kJsonForm;
}

}  // namespace

std::string md5_or_any(const std::string& type, const std::string& definition) {
  const auto md5 = ros::message_md5(type, definition);
  return md5.ok() ? *md5 : "*";
}

Connection own_connection(uint32_t id, std::string topic, const ltm::MemoryId& entity,
                          const idf::Data& value, bool is_compressed) {
  const std::string_view suited = ros::suited_type(value, is_compressed);
  Connection connection{id, topic, suited.empty() ? kTextType : std::string(suited), "", "", {}};
  connection.definition =
      ros::standard_definition(connection.type, ros::Serialization::kRos1).value_or("");
  connection.md5sum = md5_or_any(connection.type, connection.definition);
  // ROS tools ignore fields that they do not know, so the entity's name travels in the header.
  connection.others = {{"topic", std::move(topic)},
                       {std::string(kEntityField), entity.to_string()}};
  const std::string_view form = suited.empty() ? text_form(value) : "";
  if (!form.empty()) connection.others.emplace_back(kFormField, form);
  return connection;
}

ConnectionCoder ConnectionCoder::create(const Connection& connection) {
  ConnectionCoder coder;
  coder.type_ = connection.type;
  auto type =
      ros::MessageType::create(connection.type, connection.definition, ros::Serialization::kRos1);
  if (!type.ok()) {
    coder.problem_ = type.status().message();
    return coder;
  }
  coder.ros_ = *std::move(type);
  coder.form_ = Form::kMessage;
  // Only bags that an export wrote have this field; in all others, a text is just a message.
  if (connection.find(kEntityField) == nullptr) return coder;
  coder.form_ = Form::kBare;
  const std::string* form = connection.find(kFormField);
  if (form == nullptr || connection.type != kTextType) return coder;
  if (*form == kTextForm) coder.form_ = Form::kText;
  if (*form == kStringForm) coder.form_ = Form::kString;
  if (*form == kJsonForm) coder.form_ = Form::kJson;
  return coder;
}

Result<idf::Data> ConnectionCoder::value_of(std::string text) const {
  if (form_ == Form::kText) return idf::Data(idf::Dict{{"text", std::move(text)}});
  if (form_ == Form::kString) return idf::Data(std::move(text));
  auto value = idf::from_json_text(text);
  return value.ok() ? std::move(value) : data_loss("{}", value.status().message());
}

Result<ConnectionCoder::Decoded> ConnectionCoder::decode(std::span<const std::byte> bytes) const {
  if (form_ == Form::kBytes) {
    ENGRAM_ASSIGN_OR_RETURN(auto array, idf::NdArray::create(idf::ElementType::kUInt8,
                                                             {static_cast<int64_t>(bytes.size())},
                                                             Buffer::copy(bytes)));
    return Decoded{idf::Dict{{"type", text_value(type_)}, {"bytes", std::move(array)}}, {}};
  }
  ENGRAM_ASSIGN_OR_RETURN(idf::Data message, ros_->decode(bytes));
  const auto stamp = ros::header_stamp(message);
  if (form_ == Form::kMessage) return Decoded{std::move(message), stamp};
  if (form_ == Form::kBare) return Decoded{ros::without_header(message), stamp};
  ENGRAM_ASSIGN_OR_RETURN(idf::Data value, value_of(text_of(message.at("data"))));
  return Decoded{std::move(value), {}};
}

Result<std::string> ConnectionCoder::text_of_value(const idf::Data& value) const {
  if (form_ == Form::kJson) return idf::to_json_text(value);
  const std::string* text =
      form_ == Form::kText ? lone_text(value, "text") : value.get_if<std::string>();
  if (text == nullptr) return invalid_argument("is {}, needs a text", value.kind_name());
  return *text;
}

Result<std::vector<std::byte>> ConnectionCoder::encode(const idf::Data& value, Time created,
                                                       int jpeg_quality) const {
  if (form_ == Form::kMessage) return ros_->encode(value, jpeg_quality);
  if (form_ == Form::kBare) return ros::encode_bare(*ros_, value, jpeg_quality, created);
  if (form_ != Form::kBytes) {
    ENGRAM_ASSIGN_OR_RETURN(std::string text, text_of_value(value));
    return ros_->encode(idf::Dict{{"data", std::move(text)}});
  }
  const idf::Data* found = value.at("bytes");
  const auto* bytes = found == nullptr ? nullptr : found->get_if<idf::NdArray>();
  if (bytes == nullptr)
    return invalid_argument("is {}, needs a dict with 'bytes' of a '{}'", value.kind_name(), type_);
  return std::vector<std::byte>(bytes->bytes().begin(), bytes->bytes().end());
}

}  // namespace engram::datasets::rosbag
