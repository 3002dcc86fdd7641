// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>

#include "paper_objects.h"

// The three objects of the paper's timings (Peller-Konrad et al., section "Performance"): types in
// paper_objects.xml, generated structs, and here what stands in them.
namespace engram::benchmark_objects {

using paper::Complex;
using paper::Moderate;
using paper::Simple;

/// What the paper says the complex object takes; the content of `complex` is chosen so.
inline constexpr size_t kComplexBytes = 49'225;

template <typename Object>
Object example();

template <>
inline Simple example<Simple>() {
  Simple simple;
  simple.value = 42;
  return simple;
}

template <>
inline Moderate example<Moderate>() {
  Moderate moderate;
  moderate.value = 42;
  moderate.text = "hello";
  moderate.link = ltm::MemoryId::parse("Vision/RGB/head/cam").value();
  return moderate;
}

template <>
inline Complex example<Complex>() {
  Complex complex;
  complex.i = cv::Mat(128, 128, CV_8UC3, cv::Scalar(127, 127, 127));
  complex.n = example<Simple>();
  complex.l = {ltm::MemoryId::parse("M").value(), ltm::MemoryId::parse("M/C").value()};
  complex.a = {{"a", 0.9f}};
  complex.b = {{"b", 1}};
  return complex;
}

}  // namespace engram::benchmark_objects
