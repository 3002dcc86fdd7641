// SPDX-License-Identifier: Apache-2.0
#pragma once

// Annotations for clang's thread safety analysis, which `make check-locks` runs. They are empty for
// other compilers. The mutexes and locks that carry them are in ltm/core/mutex.h.
//
// Source: https://clang.llvm.org/docs/ThreadSafetyAnalysis.html

#if defined(__clang__)
#define ENGRAM_THREAD_ANNOTATION(...) __attribute__((__VA_ARGS__))
#else
#define ENGRAM_THREAD_ANNOTATION(...)
#endif

/// A class whose objects can be held, and a class that holds such an object as long as it lives.
#define ENGRAM_CAPABILITY(name) ENGRAM_THREAD_ANNOTATION(capability(name))
#define ENGRAM_SCOPED_CAPABILITY ENGRAM_THREAD_ANNOTATION(scoped_lockable)

/// Reading or writing the member needs this mutex; for a shared mutex, reading needs it shared.
#define ENGRAM_GUARDED_BY(...) ENGRAM_THREAD_ANNOTATION(guarded_by(__VA_ARGS__))
/// Reading or writing what the pointer points to needs this mutex.
#define ENGRAM_PT_GUARDED_BY(...) ENGRAM_THREAD_ANNOTATION(pt_guarded_by(__VA_ARGS__))

/// Threads that hold both mutexes must take this one first.
#define ENGRAM_ACQUIRED_BEFORE(...) ENGRAM_THREAD_ANNOTATION(acquired_before(__VA_ARGS__))
#define ENGRAM_ACQUIRED_AFTER(...) ENGRAM_THREAD_ANNOTATION(acquired_after(__VA_ARGS__))

/// The caller holds the mutex, before and after the call.
#define ENGRAM_REQUIRES(...) ENGRAM_THREAD_ANNOTATION(requires_capability(__VA_ARGS__))
#define ENGRAM_REQUIRES_SHARED(...) \
  ENGRAM_THREAD_ANNOTATION(requires_shared_capability(__VA_ARGS__))
/// The caller does not hold the mutex, because the function takes it.
#define ENGRAM_EXCLUDES(...) ENGRAM_THREAD_ANNOTATION(locks_excluded(__VA_ARGS__))

/// The function takes or releases the mutex.
#define ENGRAM_ACQUIRE(...) ENGRAM_THREAD_ANNOTATION(acquire_capability(__VA_ARGS__))
#define ENGRAM_ACQUIRE_SHARED(...) ENGRAM_THREAD_ANNOTATION(acquire_shared_capability(__VA_ARGS__))
#define ENGRAM_RELEASE(...) ENGRAM_THREAD_ANNOTATION(release_capability(__VA_ARGS__))
#define ENGRAM_RELEASE_SHARED(...) ENGRAM_THREAD_ANNOTATION(release_shared_capability(__VA_ARGS__))
#define ENGRAM_RELEASE_GENERIC(...) \
  ENGRAM_THREAD_ANNOTATION(release_generic_capability(__VA_ARGS__))

/// The function is not analysed. A comment beside it says why it is correct nevertheless.
#define ENGRAM_NO_THREAD_SAFETY_ANALYSIS ENGRAM_THREAD_ANNOTATION(no_thread_safety_analysis)
