#include "commands/ranks.hpp"

#ifdef TITOP_MPI
#define OMPI_SKIP_MPICXX  // the interface of C
#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#endif

namespace titop::command_line {

std::pair<std::size_t, std::size_t> Ranks::part(std::size_t begin, std::size_t end) const {
  const auto rank = static_cast<std::size_t>(rank_), count = static_cast<std::size_t>(count_);
  const std::size_t rows = end - begin;
  return {begin + rows * rank / count, begin + rows * (rank + 1) / count};
}

#ifdef TITOP_MPI

Ranks::Ranks() {
  int given = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
}

Ranks::~Ranks() { MPI_Finalize(); }

std::string Ranks::joined(const std::string& own) const {
  constexpr std::size_t kMost = 1u << 30;  // bytes of a message: counts are int
  if (rank_ > 0) {
    const std::uint64_t size = own.size();
    MPI_Send(&size, 1, MPI_UINT64_T, 0, 0, MPI_COMM_WORLD);
    for (std::size_t at = 0; at < own.size(); at += kMost)
      MPI_Send(own.data() + at, static_cast<int>(std::min(kMost, own.size() - at)), MPI_CHAR, 0, 0,
               MPI_COMM_WORLD);
    return {};
  }
  std::string all = own;
  for (int rank = 1; rank < count_; ++rank) {
    std::uint64_t size = 0;
    MPI_Recv(&size, 1, MPI_UINT64_T, rank, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    const std::size_t end = all.size() + size;
    std::size_t at = all.size();
    all.resize(end);
    for (; at < end; at += kMost)
      MPI_Recv(all.data() + at, static_cast<int>(std::min(kMost, end - at)), MPI_CHAR, rank, 0,
               MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  }
  return all;
}

void Ranks::abort(const char* error) const {
  if (count_ == 1) return;
  std::fprintf(stderr, "%s\n", error);
  MPI_Abort(MPI_COMM_WORLD, 1);
}

#else

Ranks::Ranks() = default;
Ranks::~Ranks() = default;
std::string Ranks::joined(const std::string& own) const { return own; }
void Ranks::abort(const char*) const {}

#endif

}  // namespace titop::command_line
