#pragma once

/// \file
/// The incremental smoother alone: `find_package(evbench COMPONENTS smoother)`, target `evbench::smoother`. It stands
/// on Eigen, fmt, zlib (for problem files) and SuiteSparse.
///
/// Smoother (core/smoother/smoother.hpp) begins with an example. FactorGraph is the problem with its estimate;
/// evaluate() gives its cost; solve_batch() solves it from scratch; read_problem() and to_graph() read a problem file.

#include "core/smoother/batch_solver.hpp"
#include "core/smoother/cost.hpp"
#include "core/smoother/problem_graph.hpp"
#include "core/smoother/smoother.hpp"
