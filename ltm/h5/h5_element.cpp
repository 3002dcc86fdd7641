// SPDX-License-Identifier: Apache-2.0
// Converts types of elements between files and memory.
#include <algorithm>
#include <array>

#include "ltm/h5/h5_state.h"

namespace engram::h5 {

namespace {

std::optional<Type> integer_type(size_t size, bool is_signed) {
  switch (size) {
    case 1:
      return is_signed ? Type::kInt8 : Type::kUInt8;
    case 2:
      return is_signed ? Type::kInt16 : Type::kUInt16;
    case 4:
      return is_signed ? Type::kInt32 : Type::kUInt32;
    case 8:
      return is_signed ? Type::kInt64 : Type::kUInt64;
    default:
      return std::nullopt;
  }
}

Element float_element(size_t size) {
  if (size == 2) return {Kind::kHalf, Type::kFloat32};
  if (size == 4) return {Kind::kNumber, Type::kFloat32};
  if (size == 8) return {Kind::kNumber, Type::kFloat64};
  return {Kind::kOther};
}

/// h5py's 1-byte enumeration: FALSE is 0, TRUE is 1.
Handle bool_type() {
  Handle type(H5Tenum_create(H5T_STD_I8LE), H5Tclose);
  const int8_t no = 0;
  const int8_t yes = 1;
  H5Tenum_insert(type, "FALSE", &no);
  H5Tenum_insert(type, "TRUE", &yes);
  return type;
}

// HDF5 has no predefined 2-byte float before 1.14.4, so the IEEE layout is set by hand: sign at bit
// 15, 5 bits of exponent from bit 10, 10 bits of mantissa.
Handle half_type() {
  Handle type(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
  H5Tset_fields(type, 15, 10, 5, 0, 10);
  H5Tset_size(type, 2);
  H5Tset_ebias(type, 15);
  return type;
}

Handle text_type(size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, size);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return type;
}

bool is_bool(hid_t stored) {
  return H5Tget_size(stored) == 1 && H5Tget_nmembers(stored) == 2 &&
         H5Tequal(stored, bool_type()) > 0;
}

bool is_bytes(hid_t stored) {
  const Handle base(H5Tget_super(stored), H5Tclose);
  return H5Tget_class(base) == H5T_INTEGER && H5Tget_size(base) == 1;
}

}  // namespace

Element element_of(hid_t stored) {
  switch (H5Tget_class(stored)) {
    case H5T_INTEGER: {
      const auto type = integer_type(H5Tget_size(stored), H5Tget_sign(stored) == H5T_SGN_2);
      return type ? Element{Kind::kNumber, *type} : Element{Kind::kOther};
    }
    case H5T_FLOAT:
      return float_element(H5Tget_size(stored));
    case H5T_ENUM:
      return is_bool(stored) ? Element{Kind::kBool} : Element{Kind::kOther};
    case H5T_STRING:
      return H5Tis_variable_str(stored) > 0
                 ? Element{Kind::kText}
                 : Element{Kind::kFixedText, Type::kUInt8, H5Tget_size(stored)};
    case H5T_VLEN:
      return is_bytes(stored) ? Element{Kind::kBytes} : Element{Kind::kOther};
    default:
      return {Kind::kOther};
  }
}

Handle memory_type(const Element& element) {
  if (element.kind == Kind::kBool) return bool_type();
  return Handle(H5Tcopy(memory_type(element.type)), H5Tclose);
}

Handle stored_type(const Element& element) {
  switch (element.kind) {
    case Kind::kHalf:
      return half_type();
    case Kind::kFixedText:
      return text_type(std::max<uint64_t>(element.text_bytes, 1));
    case Kind::kText: {
      Handle type = text_type(H5T_VARIABLE);
      H5Tset_strpad(type, H5T_STR_NULLTERM);
      H5Tset_cset(type, H5T_CSET_UTF8);
      return type;
    }
    case Kind::kBytes:
      return Handle(H5Tvlen_create(H5T_STD_U8LE), H5Tclose);
    default:
      return memory_type(element);
  }
}

}  // namespace engram::h5
