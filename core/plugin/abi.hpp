#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <version>

#ifndef NLOHMANN_JSON_VERSION_MAJOR  // before 3.11 only the full header defines it
#include <nlohmann/json.hpp>
#endif

// ABI text of a program or plugin: everything that both must have in common to exchange C++ objects. The preprocessor
// makes it a constant in the library's bytes, so it is compared before any code of the library runs.

/// Version of the plugin API. Raised with every incompatible change of the headers that plugins include (core/plugin/
/// and its includes): a virtual function, a member, a changed meaning.
#define EVBENCH_PLUGIN_API 13

// Hash of the headers that plugins include, with which this is compiled. The build of evbench and evbench_add_plugin()
// set it, so that a changed header is noticed even if the version is forgotten.
#if !defined(EVBENCH_PLUGIN_HEADERS) && __has_include(<evbench/plugin_headers.hpp>)
#include <evbench/plugin_headers.hpp>
#endif
#ifndef EVBENCH_PLUGIN_HEADERS
#define EVBENCH_PLUGIN_HEADERS "unknown"
#endif

#define EVBENCH_ABI_TEXT_OF(value) #value
#define EVBENCH_ABI_TEXT(value) EVBENCH_ABI_TEXT_OF(value)

#ifdef __clang__
#define EVBENCH_ABI_COMPILER "clang " EVBENCH_ABI_TEXT(__clang_major__)
#else
#define EVBENCH_ABI_COMPILER "gcc " EVBENCH_ABI_TEXT(__GNUC__)
#endif

#ifdef _LIBCPP_VERSION
#define EVBENCH_ABI_LIBRARY "libc++ " EVBENCH_ABI_TEXT(_LIBCPP_VERSION)
#elif defined(_GLIBCXX_DEBUG)
#define EVBENCH_ABI_LIBRARY "libstdc++ with _GLIBCXX_DEBUG, cxx11 abi " EVBENCH_ABI_TEXT(_GLIBCXX_USE_CXX11_ABI)
#else
#define EVBENCH_ABI_LIBRARY "libstdc++, cxx11 abi " EVBENCH_ABI_TEXT(_GLIBCXX_USE_CXX11_ABI)
#endif

// Memory that Eigen aligned for wider registers (-march) must be freed by code built with the same alignment.
#define EVBENCH_ABI_EIGEN \
  "Eigen " EVBENCH_ABI_TEXT(EIGEN_WORLD_VERSION) "." EVBENCH_ABI_TEXT(EIGEN_MAJOR_VERSION) "." EVBENCH_ABI_TEXT( \
      EIGEN_MINOR_VERSION) " aligned to " EVBENCH_ABI_TEXT(EIGEN_MAX_ALIGN_BYTES) " bytes, members "             \
                                                                                  "to " EVBENCH_ABI_TEXT(EIGEN_MAX_STATIC_ALIGN_BYTES)

#if defined(JSON_DIAGNOSTICS) && JSON_DIAGNOSTICS
#define EVBENCH_ABI_JSON_DIAGNOSTICS " with diagnostics"
#else
#define EVBENCH_ABI_JSON_DIAGNOSTICS ""
#endif
#define EVBENCH_ABI_JSON                                                               \
  "nlohmann json " EVBENCH_ABI_TEXT(NLOHMANN_JSON_VERSION_MAJOR) "." EVBENCH_ABI_TEXT( \
      NLOHMANN_JSON_VERSION_MINOR) "." EVBENCH_ABI_TEXT(NLOHMANN_JSON_VERSION_PATCH) EVBENCH_ABI_JSON_DIAGNOSTICS

#ifndef __has_feature
#define EVBENCH_ABI_HAS_FEATURE(feature) 0
#else
#define EVBENCH_ABI_HAS_FEATURE(feature) __has_feature(feature)
#endif
#if defined(__SANITIZE_ADDRESS__) || EVBENCH_ABI_HAS_FEATURE(address_sanitizer)
#define EVBENCH_ABI_SANITIZER "address sanitizer"
#elif defined(__SANITIZE_THREAD__) || EVBENCH_ABI_HAS_FEATURE(thread_sanitizer)
#define EVBENCH_ABI_SANITIZER "thread sanitizer"
#else
#define EVBENCH_ABI_SANITIZER "no sanitizer"
#endif

/// Beginning of the text.
#define EVBENCH_PLUGIN_ABI_MARK "evbench plugin ABI: "

namespace evbench {

/// The ABI text of this translation unit: the mark, then parts separated by "; " in a fixed order.
inline const char* plugin_abi() {
  return EVBENCH_PLUGIN_ABI_MARK
      "api " EVBENCH_ABI_TEXT(EVBENCH_PLUGIN_API) " with headers " EVBENCH_PLUGIN_HEADERS "; " EVBENCH_ABI_COMPILER
                                                  "; " EVBENCH_ABI_LIBRARY "; " EVBENCH_ABI_EIGEN "; " EVBENCH_ABI_JSON
                                                  "; " EVBENCH_ABI_SANITIZER;
}

}  // namespace evbench
