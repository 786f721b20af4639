#pragma once
/// All of the C++ interface that is installed: the core library has no records and sweeps.

#include <cvtflow/error.hpp>
#include <cvtflow/scene.hpp>
#include <cvtflow/simulation.hpp>
#include <cvtflow/snapshot.hpp>
#include <cvtflow/threads.hpp>
#include <cvtflow/version.hpp>
#if __has_include(<cvtflow/sweep.hpp>)
#include <cvtflow/recording.hpp>
#include <cvtflow/sweep.hpp>
#endif
