#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

/// The processes of one MPI run (CMake option TITOP_MPI); without MPI, or without mpirun, one.
namespace titop::command_line {

/// The constructor initialises MPI, the destructor finalises it: one object per program.
class Ranks {
 public:
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  /// True for the process that writes results and errors.
  bool first() const { return rank_ == 0; }
  /// The rows of this process, from .first up to but without .second, in the order of the ranks.
  std::pair<std::size_t, std::size_t> part(std::size_t begin, std::size_t end) const;
  /// The texts of all processes one after the other, at the first one; empty at the others. All
  /// processes must call it.
  std::string joined(const std::string& own) const;
  /// For an error that other processes may not have: prints it and ends all processes with exit
  /// code 1; does nothing if there is one process.
  void abort(const char* error) const;

 private:
  int rank_ = 0, count_ = 1;
};

}  // namespace titop::command_line
