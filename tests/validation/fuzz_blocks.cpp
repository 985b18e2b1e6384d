// SPDX-License-Identifier: GPL-3.0-or-later
// Throws random blocks on random terrain, in 3D or on profiles: fuzz_blocks 3D|2D FIRST COUNT. Prints every fault with its number, and what happened in
// all. Ends with 1 if there is a fault. The numbers of scenes that once failed are kept in tests/verification/fuzz_test.cpp and plane_test.cpp.
#include "support/fuzz.hpp"
#include "support/plane_fuzz.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>

namespace {

struct Account {
    std::array<std::int64_t, 4> reasons{};
    std::int64_t faults = 0;
    scree::TrajectoryCounters counters;
    void merge(const Account& other) {
        for (std::size_t k = 0; k < reasons.size(); ++k) reasons[k] += other.reasons[k];
        faults += other.faults;
        counters.merge(other.counters);
    }
};

}  // namespace

int main(int argc, char** argv) {
    using namespace scree::test;
    const std::string dimension = argc == 4 ? argv[1] : "";
    if (dimension != "2D" && dimension != "3D") {
        std::fprintf(stderr, "fuzz_blocks 3D|2D FIRST COUNT: numbers of the scenes\n");
        return 2;
    }
    const std::uint64_t first = std::strtoull(argv[2], nullptr, 10), count = std::strtoull(argv[3], nullptr, 10);
    tbb::enumerable_thread_specific<Account> accounts;
    std::mutex printing;
    const auto enter = [&](const auto& scene, const auto& outcome) {
        Account& account = accounts.local();
        ++account.reasons[static_cast<std::size_t>(outcome.end.reason)];
        account.counters.merge(outcome.end.counters);
        if (outcome.fault.empty()) return;
        ++account.faults;
        const std::lock_guard lock(printing);
        std::printf("%s: %s\n", scene.what.c_str(), outcome.fault.c_str());
        std::fflush(stdout);
    };
    tbb::parallel_for(first, first + count, [&](std::uint64_t number) {
        if (dimension == "3D") {
            const FuzzScene scene = fuzz_scene(number);
            enter(scene, fuzz_block(scene, fuzz_settings()));
        } else {
            const PlaneFuzzScene scene = plane_fuzz_scene(number);
            enter(scene, plane_fuzz_block(scene, fuzz_settings()));
        }
    });
    Account all;
    for (const Account& account : accounts) all.merge(account);
    const scree::TrajectoryCounters& c = all.counters;
    std::printf("%llu blocks: %lld faults;", static_cast<unsigned long long>(count),
                static_cast<long long>(all.faults));
    for (std::size_t k = 0; k < all.reasons.size(); ++k)
        std::printf(" %lld %s", static_cast<long long>(all.reasons[k]), scree::kStopReasonNames[k]);
    std::printf(
        "\ncontact problems %lld, above the tolerance %lld; penetration p99 %.3g m, p99.9 %.3g m, p99.99 %.3g m, "
        "largest %.3g m\n",
        static_cast<long long>(c.contact_problems), static_cast<long long>(c.unconverged_problems),
        c.penetration_quantile(0.99), c.penetration_quantile(0.999), c.penetration_quantile(0.9999),
        c.largest_penetration);
    std::printf("restitution lowered %lld, rested turning %lld, energy taken back %lld (largest %.3g m)\n",
                static_cast<long long>(c.restitution_capped), static_cast<long long>(c.rested_turning),
                static_cast<long long>(c.energy_capped), c.largest_rise_taken_back);
    return all.faults > 0 ? 1 : 0;
}
