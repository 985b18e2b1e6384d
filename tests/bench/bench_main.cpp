// SPDX-License-Identifier: GPL-3.0-or-later
// Google Benchmark with the core's clock in the context of the output.
#include "bench/core_clock.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::AddCustomContext("dependent_additions_per_s",
                                std::to_string(std::llround(scree::bench::dependent_additions_per_second(4'000'000))));
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
