#pragma once
/// All of the C++ interface that is installed: the core library has no files of results, sweeps and tuning.

#include <cvtflow/error.hpp>
#include <cvtflow/scene.hpp>
#include <cvtflow/simulation.hpp>
#include <cvtflow/snapshot.hpp>
#include <cvtflow/threads.hpp>
#if __has_include(<cvtflow/record.hpp>)
#include <cvtflow/record.hpp>
#include <cvtflow/sweep.hpp>
#include <cvtflow/tune.hpp>
#include <cvtflow/version.hpp>
#endif
