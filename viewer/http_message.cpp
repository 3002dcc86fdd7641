// SPDX-License-Identifier: Apache-2.0
#include "viewer/http_message.h"

namespace engram::viewer {

namespace {

using OrderedJson = nlohmann::ordered_json;

int http_status_of(StatusCode code) {
  switch (code) {
    case StatusCode::kOk:
      return 200;
    case StatusCode::kInvalidArgument:
      return 400;
    case StatusCode::kNotFound:
      return 404;
    case StatusCode::kAlreadyExists:
    case StatusCode::kFailedPrecondition:
      return 409;
    case StatusCode::kDataLoss:
      return 500;
    case StatusCode::kResourceExhausted:
      return 413;
    case StatusCode::kUnavailable:
    case StatusCode::kCancelled:
      break;
  }
  return 503;
}

}  // namespace

std::string json_text(const OrderedJson& json) {
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

HttpResponse json_response(const OrderedJson& json) {
  return {.body = json_text(json)};
}

std::string header_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c >= ' ' && c <= '~' && c != '%')
      out += c;
    else
      out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

HttpResponse error_response(const Status& status) {
  return error_response(http_status_of(status.code()), status);
}

HttpResponse error_response(int http_status, const Status& status) {
  HttpResponse response = json_response(
      {{"error", {{"code", to_string(status.code())}, {"message", status.message()}}}});
  response.status = http_status;
  return response;
}

}  // namespace engram::viewer
