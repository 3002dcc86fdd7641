// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/errors.h"

#include <pybind11/pybind11.h>

namespace engram::python {

namespace {

namespace py = pybind11;

const char* class_of(StatusCode code) {
  switch (code) {
    case StatusCode::kInvalidArgument:
      return "InvalidArgumentError";
    case StatusCode::kNotFound:
      return "NotFoundError";
    case StatusCode::kAlreadyExists:
      return "AlreadyExistsError";
    case StatusCode::kFailedPrecondition:
      return "FailedPreconditionError";
    case StatusCode::kDataLoss:
      return "DataLossError";
    case StatusCode::kResourceExhausted:
      return "ResourceExhaustedError";
    case StatusCode::kUnavailable:
      return "UnavailableError";
    case StatusCode::kCancelled:
      return "CancelledError";
    case StatusCode::kOk:
      break;
  }
  return "EngramError";
}

}  // namespace

void raise(const Status& status) {
  const py::object type = py::module_::import("engram.errors").attr(class_of(status.code()));
  PyErr_SetString(type.ptr(), status.message().c_str());
  throw py::error_already_set();
}

}  // namespace engram::python
