#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <titop/blocks/fe/mat.hpp>
#include <titop/graph/error.hpp>
#include <vector>
#ifdef TITOP_MATIO
#include <matio.h>
#endif

#include "support/quick.hpp"

/// MAT-files of 480 bytes of which one size is damaged: blocks/fe/mat.cpp against libmatio, which
/// allocates by these sizes before it looks whether the file has as much, and returns the first one
/// as a matrix of 1e9 entries, of which the file has 36. Debian 12, libmatio 1.5.23, memory in MB
/// (titop, libmatio):
///
///     damaged size                address space    resident     seconds
///     32768 x 32768, 36 numbers   0   8192         0      0     0.000  0.000
///     name of 2 GB                0   2048         0   2048     0.000  4.5
///     dimensions of 2 GB          0   4096         0      0     0.000  0.000
///
/// It runs against libmatio where that is installed; the library does without.
namespace titop_bench {
namespace {

namespace fs = std::filesystem;

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string element(std::uint32_t type, std::string data) {
  const std::string tag = raw(type) + raw(static_cast<std::uint32_t>(data.size()));
  data.resize((data.size() + 7) / 8 * 8);
  return tag + data;
}

constexpr std::size_t kDimensions = 128 + 8 + 16, kName = kDimensions + 16;  ///< their tags

/// A matrix K of 36 doubles, with these dimensions.
std::string file(std::int32_t rows, std::int32_t cols) {
  std::string head = "MATLAB 5.0 MAT-file";
  head.resize(124, ' ');
  head += raw(std::uint16_t{0x0100}) + raw(std::uint16_t{('M' << 8) + 'I'});
  const std::string flags = raw(std::uint32_t{6}) + raw(std::uint32_t{0});
  return head + element(14, element(6, flags) + element(5, raw(rows) + raw(cols)) +
                                element(1, "K") + element(9, std::string(36 * 8, '\0')));
}

std::string with_length(std::string bytes, std::size_t tag, std::uint32_t length) {
  return bytes.replace(tag + 4, 4, raw(length));
}

/// Lines of /proc/self/status, in kB.
long status(const std::string& key) {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;)
    if (long value = 0; word == key + ":" && in >> value) return value;
  return 0;
}

struct Measured {
  long reserved = 0, resident = 0;  ///< kB
  double seconds = 0;
  std::array<char, 160> outcome = {};
};

/// In a process of its own, since peaks are those of a process.
Measured measured(const std::function<std::string()>& read) {
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    Measured m{.reserved = -status("VmSize"), .resident = -status("VmRSS")};
    const auto begin = std::chrono::steady_clock::now();
    const std::string outcome = read();
    m.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    m.reserved += status("VmPeak"), m.resident += status("VmHWM");
    outcome.copy(m.outcome.data(), m.outcome.size() - 1);
    const bool written = write(pipe_ends[1], &m, sizeof m) == static_cast<ssize_t>(sizeof m);
    _exit(written ? 0 : 1);
  }
  Measured m;
  close(pipe_ends[1]);
  if (child < 0 || ::read(pipe_ends[0], &m, sizeof m) != static_cast<ssize_t>(sizeof m))
    std::strcpy(m.outcome.data(), "the process ended");
  close(pipe_ends[0]);
  waitpid(child, nullptr, 0);
  return m;
}

std::string by_titop(const fs::path& path) try {
  const std::vector<titop::fe::Op4Matrix> all = titop::fe::read_mat(path);
  if (all.size() == 1 && !all[0].unread.empty()) return "not read: " + all[0].unread;
  return fmt::format("{} variables", all.size());
} catch (const titop::Error& e) {
  return "refused: " + e.mistakes().front().message;
}

#ifdef TITOP_MATIO
std::string by_matio(const fs::path& path) {
  std::string text;
  mat_t* in = Mat_Open(path.c_str(), MAT_ACC_RDONLY);
  if (in == nullptr) return "refused";
  while (matvar_t* v = Mat_VarReadNext(in)) {
    text += fmt::format("{}: {} x {} ", v->name, v->dims[0], v->dims[1]);
    Mat_VarFree(v);
  }
  Mat_Close(in);
  return text.empty() ? "0 variables" : text;
}
#endif

void print(const char* damage, const char* reader, const Measured& m) {
  std::printf("%-30s %-9s %8ld %8ld %8.3f  %s\n", damage, reader, m.reserved / 1024,
              m.resident / 1024, m.seconds, m.outcome.data());
}

int run([[maybe_unused]] bool quick) {
  const std::vector<std::pair<const char*, std::string>> files = {
      {"32768 x 32768, 36 numbers", file(32768, 32768)},
      {"name of 2 GB", with_length(file(6, 6), kName, 0x7ffffff0)},
      {"dimensions of 2 GB", with_length(file(6, 6), kDimensions, 0x7ffffff8)}};
  const fs::path path = fs::temp_directory_path() / fmt::format("titop-bench-{}.mat", getpid());
  bool ok = true;
  std::printf("%-30s %-9s %8s %8s %8s\n", "damaged size", "reader", "MB", "resident", "s");
  for (const auto& [damage, bytes] : files) {
    std::ofstream(path, std::ios::binary) << bytes;
    const Measured own = measured([&] { return by_titop(path); });
    print(damage, "titop", own);
    const std::string outcome = own.outcome.data();
    ok = ok && own.reserved < 100 * 1024 && own.resident < 100 * 1024 &&
         (outcome.starts_with("refused") || outcome.starts_with("not read"));
#ifdef TITOP_MATIO
    if (!quick) print(damage, "libmatio", measured([&] { return by_matio(path); }));
#endif
  }
  fs::remove(path);
  return ok ? 0 : 1;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) { return titop_bench::run(titop_bench::is_quick(argc, argv)); }
