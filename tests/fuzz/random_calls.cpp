// Makes random calls of the C interface: umbrage_random_calls [SECONDS [SEED [THREADS]]], default 60, 1 and 1. Each
// seed is one sequence; UMBRAGE_TRACE_CALLS in the environment prints its calls.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "calls.h"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  constexpr std::size_t kBytes = 4096;  // about 200 calls
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60.0;
  unsigned seed = argc > 2 ? unsigned(std::atol(argv[2])) : 1;
  const int threads = argc > 3 ? std::atoi(argv[3]) : 1;
  const auto start = Clock::now();
  const auto elapsed_s = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  umbrage::fuzz::CallCounts all;
  unsigned seeds = 0;
  do {
    std::fprintf(stderr, "\rseed %u ", seed);
    std::mt19937 random(seed++);
    std::string bytes(kBytes, '\0');
    for (char& byte : bytes) byte = char(random());
    all += threads > 1 ? umbrage::fuzz::make_calls_in_threads(bytes, threads) : umbrage::fuzz::make_calls(bytes);
    ++seeds;
  } while (elapsed_s() < seconds);
  std::fprintf(stderr, "\r");
  std::printf("%u seeds, %ld calls, %ld of them failed as they should, %ld pictures, %ld cancelled, in %.0f s\n", seeds,
              all.calls, all.failed, all.executed, all.cancelled, elapsed_s());
  return 0;
}
