// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

constexpr std::string_view kTakenBack = "Received RST_STREAM";

}  // namespace

grpc::StatusCode to_grpc_code(StatusCode code) {
  switch (code) {
    case StatusCode::kOk: return grpc::StatusCode::OK;
    case StatusCode::kInvalidArgument: return grpc::StatusCode::INVALID_ARGUMENT;
    case StatusCode::kNotFound: return grpc::StatusCode::NOT_FOUND;
    case StatusCode::kAlreadyExists: return grpc::StatusCode::ALREADY_EXISTS;
    case StatusCode::kFailedPrecondition: return grpc::StatusCode::FAILED_PRECONDITION;
    case StatusCode::kDataLoss: return grpc::StatusCode::DATA_LOSS;
    case StatusCode::kResourceExhausted: return grpc::StatusCode::RESOURCE_EXHAUSTED;
    case StatusCode::kUnavailable: return grpc::StatusCode::UNAVAILABLE;
    case StatusCode::kCancelled: return grpc::StatusCode::CANCELLED;
  }
  return grpc::StatusCode::UNKNOWN;
}

grpc::Status to_grpc(const Status& status) {
  return status.ok() ? grpc::Status() : grpc::Status(to_grpc_code(status.code()), status.message());
}

Status to_status(grpc::StatusCode code, const std::string& message) {
  switch (code) {
    case grpc::StatusCode::OK: return {};
    case grpc::StatusCode::INVALID_ARGUMENT:
    case grpc::StatusCode::OUT_OF_RANGE: return Status(StatusCode::kInvalidArgument, message);
    case grpc::StatusCode::NOT_FOUND: return Status(StatusCode::kNotFound, message);
    case grpc::StatusCode::ALREADY_EXISTS: return Status(StatusCode::kAlreadyExists, message);
    case grpc::StatusCode::FAILED_PRECONDITION:
      return Status(StatusCode::kFailedPrecondition, message);
    case grpc::StatusCode::UNAUTHENTICATED:
      return failed_precondition("not let in: {}", message);
    case grpc::StatusCode::PERMISSION_DENIED: return failed_precondition("not allowed: {}", message);
    case grpc::StatusCode::UNIMPLEMENTED:
      return failed_precondition("the other side does not know this: {}", message);
    case grpc::StatusCode::DATA_LOSS: return Status(StatusCode::kDataLoss, message);
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
      // No answer: gRPC takes streams back where others filled its quota of memory. They may be
      // opened anew.
      return Status(message.starts_with(kTakenBack) ? StatusCode::kUnavailable
                                                    : StatusCode::kResourceExhausted,
                    message);
    case grpc::StatusCode::CANCELLED: return Status(StatusCode::kCancelled, message);
    default: return Status(StatusCode::kUnavailable, message);
  }
}

Status to_status(const grpc::Status& status) {
  return to_status(status.error_code(), status.error_message());
}

}  // namespace engram::server
