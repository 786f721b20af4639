#pragma once
/// Marks what the shared library shows. All names of the C++ interface live in an inline namespace that carries the major version, so that
/// two versions may be loaded side by side.

#define CVTFLOW_EXPORT __attribute__((visibility("default")))
