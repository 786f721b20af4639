#pragma once
/// All of the C++ interface.

#include <cvtflow/error.hpp>
#include <cvtflow/record.hpp>
#include <cvtflow/scene.hpp>
#include <cvtflow/simulation.hpp>
#include <cvtflow/snapshot.hpp>
#include <cvtflow/sweep.hpp>
#include <cvtflow/threads.hpp>
#include <cvtflow/tune.hpp>
#include <cvtflow/version.hpp>
