// SPDX-License-Identifier: GPL-3.0-or-later
// The gap between measurement and simulation against closed forms, and its intervals against their own promise: samples are drawn again and again
// with fixed seeds, and what is said to hold in 95 % of the cases must hold in 95 % of them, within what a count of so many cases can show.
#include "scree/inference/discrepancy.hpp"

#include "inference/gap_statistic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace scree {
namespace {

constexpr int kRepetitions = 500;
constexpr std::int64_t kDraws = 100;
constexpr std::size_t kSimulated = 1000;
constexpr double kWide =
    3.3;  // standard errors of an estimate: one test in a thousand fails by chance, and the seeds are fixed

RandomStream stream(std::uint64_t number) {
    return {20240612, number, RandomPurpose::Effect};
}

double normal_cdf(double x) {
    return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

std::vector<double> draws(std::size_t n, const std::function<double()>& draw) {
    std::vector<double> values(n);
    for (double& v : values) v = draw();
    return values;
}

struct Moments {
    double mean = 0.0, error = 0.0;  ///< error: standard error of the mean
};
Moments moments(const std::vector<double>& values) {
    const double n = static_cast<double>(values.size());
    double sum = 0.0, squares = 0.0;
    for (const double v : values) sum += v;
    for (const double v : values) squares += (v - sum / n) * (v - sum / n);
    return {sum / n, std::sqrt(squares / (n - 1.0) / n)};
}

/// A share of `total` cases that should be `expected`.
void expect_share(int cases, int total, double expected, const char* what) {
    const double slack = kWide * std::sqrt(expected * (1.0 - expected) / total);
    EXPECT_NEAR(static_cast<double>(cases) / total, expected, slack) << what;
}

// --- distances: closed forms ---

TEST(EnergyDistance, OfShiftedNormalsIsTheClosedForm) {
    // E|X-Y| for X-Y normal with mean d and deviation s = sqrt 2 is s sqrt(2/pi) exp(-d^2/2s^2) + d (1 - 2 Phi(-d/s))
    constexpr std::size_t n = 200'000;
    for (const double d : {0.0, 0.3, 1.0, 3.0}) {
        RandomStream random = stream(1);
        const auto x = draws(n, [&] { return random.normal(); });
        const auto y = draws(n, [&] { return d + random.normal(); });
        const double s = std::numbers::sqrt2;
        const double between = s * std::sqrt(2.0 / std::numbers::pi) * std::exp(-d * d / (2.0 * s * s)) +
                               d * (1.0 - 2.0 * normal_cdf(-d / s));
        const double exact = 2.0 * between - 2.0 * 2.0 / std::sqrt(std::numbers::pi);
        // the V-statistic lies floor = a (1/n + 1/N) above; its own deviation is of the order sqrt(exact/n)
        const double floor = 2.0 / std::sqrt(std::numbers::pi) * 2.0 / n;
        EXPECT_NEAR(line_distance(sorted_sample(x), sorted_sample(y)).energy, exact + floor,
                    4.0 * std::sqrt((exact + floor) / n) + floor)
            << "shift " << d;
        EXPECT_NEAR(line_distance(sorted_sample(x), sorted_sample(y)).wasserstein, d, 0.02) << "shift " << d;
    }
}

TEST(EnergyDistance, OfShiftedUniformsIsTheClosedForm) {
    // 2 integral (F-G)^2 over two uniforms of width 1 shifted by d <= 1: 2 (d^2 - d^3/3); grids of n points instead of samples: error 1/n
    constexpr int n = 20'000;
    std::vector<double> x(n);
    for (int k = 0; k < n; ++k) x[static_cast<std::size_t>(k)] = (k + 0.5) / n;
    for (const double d : {0.1, 0.5, 1.0}) {
        std::vector<double> y = x;
        for (double& v : y) v += d;
        const LineDistance distance = line_distance(sorted_sample(x), sorted_sample(y));
        EXPECT_NEAR(distance.energy, 2.0 * (d * d - d * d * d / 3.0), 2.0 / n) << "shift " << d;
        EXPECT_NEAR(distance.wasserstein, d, 1e-9) << "shift " << d;
    }
}

TEST(EnergyDistance, OfExponentialsIsTheClosedForm) {
    // rates a and b: integral (exp(-ax) - exp(-bx))^2 dx = 1/(2a) + 1/(2b) - 2/(a+b)
    constexpr std::size_t n = 200'000;
    RandomStream random = stream(2);
    const double a = 1.0, b = 2.5;
    const auto x = draws(n, [&] { return -std::log(1.0 - random.uniform()) / a; });
    const auto y = draws(n, [&] { return -std::log(1.0 - random.uniform()) / b; });
    const double exact = 2.0 * (0.5 / a + 0.5 / b - 2.0 / (a + b));
    EXPECT_NEAR(line_distance(sorted_sample(x), sorted_sample(y)).energy, exact, 4.0 * std::sqrt(exact / n));
    EXPECT_NEAR(mean_difference(x), 1.0 / a, 0.01);  // Gini's mean difference of an exponential is its mean
}

TEST(EnergyScore, OfANormalIsItsCrps) {
    // CRPS of a standard normal at y (Gneiting & Raftery 2007, eq 21): y (2 Phi(y) - 1) + 2 phi(y) - 1/sqrt pi
    RandomStream random = stream(3);
    PointSample members;
    members.values = draws(6000, [&] { return random.normal(); });
    for (const double y : {-1.5, 0.0, 0.7, 3.0}) {
        const double density = std::exp(-0.5 * y * y) / std::sqrt(2.0 * std::numbers::pi);
        const double exact = y * (2.0 * normal_cdf(y) - 1.0) + 2.0 * density - 1.0 / std::sqrt(std::numbers::pi);
        EXPECT_NEAR(energy_score(std::vector{y}, members), exact, 0.03) << "at " << y;
    }
}

TEST(Pit, IsUniformUnderTheModelEvenWithTies) {
    // Kolmogorov's statistic stays below its 99.9 % quantile 1.95 / sqrt n, for continuous values and for counts of few values
    for (const bool ties : {false, true}) {
        RandomStream random = stream(4);
        const auto draw = [&] { return ties ? std::floor(4.0 * random.uniform()) : random.normal(); };
        std::vector<double> u;
        for (int k = 0; k < 2000; ++k) {
            const auto members = draws(20, draw);
            u.push_back(pit_value(draw(), members, random.uniform()));
        }
        std::sort(u.begin(), u.end());
        double worst = 0.0;
        for (std::size_t k = 0; k < u.size(); ++k)
            worst =
                std::max({worst, static_cast<double>(k + 1) / 2000.0 - u[k], u[k] - static_cast<double>(k) / 2000.0});
        EXPECT_LT(worst, 1.95 / std::sqrt(2000.0)) << (ties ? "ties" : "continuous");
    }
}

// --- gaps: tables as field tests give them ---

/// One column of distances, pooled.
ObservationTable pool(const std::vector<double>& values) {
    ObservationTable table;
    table.columns = {{Quantity::Along, -1}};
    table.values = {values};
    table.block.assign(values.size(), -1);
    return table;
}

const Observable kPooled{"distance along", "m", {{Quantity::Along, -1}}, false, false, true, {}};
const Observable kMatched{"distance along", "m", {{Quantity::Along, -1}}, false, true, true, {}};

/// What many repetitions of a test come to.
struct Account {
    std::vector<double> gaps;
    int in_chance = 0, in_interval = 0, significant = 0;

    void add(const Gap& gap, double expected) {
        gaps.push_back(gap.gap);
        in_chance += gap.gap >= gap.chance.low && gap.gap <= gap.chance.high;
        in_interval += gap.interval.low <= expected && expected <= gap.interval.high;
        significant += gap.p <= 0.05;
    }
};

Account pooled_tests(std::size_t n, double shift, double expected, const std::function<double(RandomStream&)>& law) {
    Account account;
    for (int r = 0; r < kRepetitions; ++r) {
        RandomStream random = stream(100 + static_cast<std::uint64_t>(r));
        const auto simulated = pool(draws(kSimulated, [&] { return law(random); }));
        const auto measured = pool(draws(n, [&] { return shift + law(random); }));
        const DiscrepancySettings settings{kDraws, static_cast<std::uint64_t>(r), false};
        const std::vector<double> scales{1.0};
        account.add(compare_tables(measured, simulated, std::span(&kPooled, 1), scales, settings).observables[0].pooled,
                    expected);
    }
    return account;
}

TEST(PooledGap, IsOneUnderTheNullWithinItsIntervals) {
    struct Law {
        const char* name;
        std::function<double(RandomStream&)> draw;
    };
    const Law laws[] = {
        {"normal", [](RandomStream& r) { return r.normal(); }},
        {"exponential", [](RandomStream& r) { return -std::log(1.0 - r.uniform()); }},
        {"two heaps", [](RandomStream& r) { return (r.uniform() < 0.3 ? 0.0 : 8.0) + r.normal(); }},
    };
    for (const Law& law : laws) {
        const Account account = pooled_tests(41, 0.0, 1.0, law.draw);
        const Moments gap = moments(account.gaps);
        EXPECT_NEAR(gap.mean, 1.0, kWide * gap.error) << law.name;
        expect_share(account.in_chance, kRepetitions, 0.95, law.name);
        expect_share(account.significant, kRepetitions, 0.05, law.name);
        EXPECT_GE(account.in_interval, 0.92 * kRepetitions) << "interval of the gap, " << law.name;
    }
}

TEST(PooledGap, GrowsWithTheShiftAsItShould) {
    // E gap = 1 + D / floor with D of two normals in closed form
    constexpr std::size_t n = 41;
    double before = 1.0;
    for (const double d : {0.25, 0.5, 1.0, 2.0}) {
        const double between = 2.0 / std::sqrt(std::numbers::pi) * std::exp(-0.25 * d * d) +
                               d * (1.0 - 2.0 * normal_cdf(-d / std::numbers::sqrt2));
        const double spread = 2.0 / std::sqrt(std::numbers::pi);
        const double expected = 1.0 + (2.0 * between - 2.0 * spread) / (spread * (1.0 / n + 1.0 / kSimulated));
        const Account account = pooled_tests(n, d, expected, [](RandomStream& r) { return r.normal(); });
        const Moments gap = moments(account.gaps);
        EXPECT_NEAR(gap.mean, expected, kWide * gap.error + 0.01 * expected) << "shift " << d;
        EXPECT_GT(gap.mean, before);
        EXPECT_GE(account.in_interval, 0.92 * kRepetitions) << "interval of the gap at shift " << d;
        before = gap.mean;
    }
}

// Of a distance, which chance can only enlarge: blocks drawn again are farther away than the blocks were.
TEST(WassersteinGap, LiesWithinItsInterval) {
    for (const double shift : {0.0, 0.5, 2.0}) {
        int covered = 0;
        for (std::uint64_t r = 0; r < 100; ++r) {
            RandomStream random = stream(300 + r);
            const auto simulated = pool(draws(kSimulated, [&] { return random.normal(); }));
            const auto measured = pool(draws(41, [&] { return shift + random.normal(); }));
            const std::vector<double> scales{1.0};
            const WassersteinGap gap =
                compare_tables(measured, simulated, std::span(&kPooled, 1), scales, {kDraws, r, true})
                    .observables[0]
                    .wasserstein.value();
            EXPECT_LE(gap.interval.low, gap.distance);
            EXPECT_GE(gap.interval.high, gap.distance);
            covered += gap.interval.low <= shift && shift <= gap.interval.high;
        }
        EXPECT_GE(covered, shift > 0.0 ? 88 : 0) << shift;
    }
}

/// Forty blocks, each with a law of its own, the heavier the farther.
struct MatchedTest {
    ObservationTable measured, simulated;
};
MatchedTest matched_test(std::uint64_t number, double shift, double widened, std::size_t columns, bool holes) {
    constexpr std::size_t kBlocks = 40, kRepeats = 20;
    RandomStream random = stream(1000 + number);
    MatchedTest test;
    for (std::size_t c = 0; c < columns; ++c) {
        test.measured.columns.push_back({c == 0 ? Quantity::Along : Quantity::Lateral, -1});
        test.measured.values.emplace_back();
        test.simulated.values.emplace_back();
    }
    test.simulated.columns = test.measured.columns;
    for (std::size_t r = 0; r < kRepeats; ++r) {
        for (std::size_t b = 0; b < kBlocks; ++b) {
            test.simulated.block.push_back(static_cast<std::int32_t>(b));
            for (auto& column : test.simulated.values)
                column.push_back(static_cast<double>(b) + (1.0 + 0.1 * static_cast<double>(b)) * random.normal());
        }
    }
    for (std::size_t b = 0; b < kBlocks; ++b) {
        test.measured.block.push_back(static_cast<std::int32_t>(b));
        for (auto& column : test.measured.values) {
            const double value =
                static_cast<double>(b) + shift + widened * (1.0 + 0.1 * static_cast<double>(b)) * random.normal();
            column.push_back(holes && b % 5 == 0 ? kNaN : value);
        }
    }
    return test;
}

struct MatchedAccount {
    Account pooled, score, overall;
};
MatchedAccount matched_tests(double shift, double widened, const Observable& observable, bool holes) {
    MatchedAccount account;
    for (int r = 0; r < kRepetitions; ++r) {
        const MatchedTest test =
            matched_test(static_cast<std::uint64_t>(r), shift, widened, observable.columns.size(), holes);
        const std::vector<double> scales = column_scales(test.simulated);
        const DiscrepancySettings settings{kDraws, static_cast<std::uint64_t>(r), false};
        const Discrepancy d =
            compare_tables(test.measured, test.simulated, std::span(&observable, 1), scales, settings);
        account.pooled.add(d.observables[0].pooled, 1.0);
        account.score.add(*d.observables[0].score, 1.0);
        account.overall.add(d.overall, 1.0);
    }
    return account;
}

/// The measured values of known blocks are not drawn from a pool but one from each block: the floor must know that.
void expect_null(const Observable& observable, bool holes) {
    const MatchedAccount account = matched_tests(0.0, 1.0, observable, holes);
    for (const Account* a : {&account.pooled, &account.score, &account.overall}) {
        const Moments gap = moments(a->gaps);
        const char* what = a == &account.score ? "score" : a == &account.pooled ? "pooled" : "overall";
        EXPECT_NEAR(gap.mean, 1.0, kWide * gap.error) << what;
        expect_share(a->in_chance, kRepetitions, 0.95, what);
        expect_share(a->significant, kRepetitions, 0.05, what);
    }
    EXPECT_GE(account.score.in_interval, 0.92 * kRepetitions) << "interval of the score gap";
    EXPECT_GE(account.pooled.in_interval, 0.92 * kRepetitions) << "interval of the pooled gap";
    EXPECT_GE(account.overall.in_interval, 0.92 * kRepetitions) << "interval of the overall gap";
}

TEST(MatchedGap, IsOneUnderTheNullWithinItsIntervals) {
    expect_null(kMatched, false);
}

TEST(MatchedGap, IsOneInThePlaneWithSomeBlocksNotMeasured) {
    Observable plane = kMatched;
    plane.columns = {{Quantity::Along, -1}, {Quantity::Lateral, -1}};
    expect_null(plane, true);
}

TEST(MatchedGap, GrowsWithShiftAndSpread) {
    const MatchedAccount shifted = matched_tests(3.0, 1.0, kMatched, false),
                         widened = matched_tests(0.0, 2.5, kMatched, false);
    EXPECT_GT(moments(shifted.pooled.gaps).mean, 3.0);
    EXPECT_GT(moments(shifted.score.gaps).mean, 1.2);
    EXPECT_GT(moments(widened.score.gaps).mean, 1.5);
    EXPECT_GT(shifted.pooled.significant, 0.95 * kRepetitions);
    EXPECT_GT(widened.score.significant, 0.95 * kRepetitions);
}

TEST(MatchedGap, SeesWhichBlockWentWhereWhenThePoolDoesNot) {
    // the measured values of all blocks exchanged: the same pool, other blocks. Only the score can know
    int pooled = 0, score = 0;
    for (std::uint64_t r = 0; r < 100; ++r) {
        MatchedTest test = matched_test(r, 0.0, 1.0, 1, false);
        std::reverse(test.measured.values[0].begin(), test.measured.values[0].end());
        const std::vector<double> scales = column_scales(test.simulated);
        const Discrepancy d =
            compare_tables(test.measured, test.simulated, std::span(&kMatched, 1), scales, {kDraws, r, false});
        pooled += d.observables[0].pooled.beyond_chance();
        score += d.observables[0].score->beyond_chance();
    }
    EXPECT_LT(pooled, 15);
    EXPECT_EQ(score, 100);
}

TEST(ShareGap, IsOneUnderTheNullWithinItsIntervals) {
    // zones of 5, 25 and 70 %, known as counts of 50 blocks
    Observable zones{"deposit zones",
                     "-",
                     {{Quantity::InZone, 0}, {Quantity::InZone, 1}, {Quantity::InZone, 2}},
                     true,
                     false,
                     true,
                     {}};
    const double shares[] = {0.05, 0.25, 0.70};
    Account account;
    for (int r = 0; r < kRepetitions; ++r) {
        RandomStream random = stream(5000 + static_cast<std::uint64_t>(r));
        ObservationTable measured, simulated;
        measured.columns = simulated.columns = zones.columns;
        measured.values.resize(3);
        simulated.values.resize(3);
        const auto zone = [&] {
            const double u = random.uniform();
            return u < shares[0] ? 0U : u < shares[0] + shares[1] ? 1U : 2U;
        };
        for (int k = 0; k < 1000; ++k) {
            const unsigned z = zone();
            simulated.block.push_back(-1);
            for (unsigned c = 0; c < 3; ++c) simulated.values[c].push_back(c == z ? 1.0 : 0.0);
        }
        zones.counts = {{0, 0, 0, 50}, {0, 1, 0, 50}, {0, 2, 0, 50}};
        for (int k = 0; k < 50; ++k) ++zones.counts[zone()].count;
        const std::vector<double> scales(3, 1.0);
        account.add(compare_tables(measured, simulated, std::span(&zones, 1), scales,
                                   {kDraws, static_cast<std::uint64_t>(r), false})
                        .observables[0]
                        .pooled,
                    1.0);
    }
    const Moments gap = moments(account.gaps);
    EXPECT_NEAR(gap.mean, 1.0, kWide * gap.error);
    expect_share(account.in_chance, kRepetitions, 0.95, "shares");
}

TEST(ShareGap, OfCountsIsTheClosedForm) {
    // one zone, p = 0.4 of 50 measured, q = 0.1 of 1000 simulated: D = 2 (p-q)^2, floor = 2 q (1-q) N/(N-1) (1/50 + 1/1000)
    Observable zone{"deposit zones", "-", {{Quantity::InZone, 0}}, true, false, true, {{0, 0, 20, 50}}};
    ObservationTable measured, simulated;
    measured.columns = simulated.columns = zone.columns;
    measured.values.resize(1);
    simulated.values.resize(1);
    for (int k = 0; k < 1000; ++k) {
        simulated.block.push_back(-1);
        simulated.values[0].push_back(k % 10 == 0 ? 1.0 : 0.0);
    }
    const std::vector<double> scales{1.0};
    const ObservableGap gap =
        compare_tables(measured, simulated, std::span(&zone, 1), scales, {0, 1, false}).observables[0];
    EXPECT_NEAR(gap.pooled.distance, 2.0 * 0.3 * 0.3, 1e-12);
    EXPECT_NEAR(gap.pooled.floor, 2.0 * 0.09 * 1000.0 / 999.0 * (1.0 / 50 + 1.0 / 1000), 1e-12);
}

TEST(ShareGap, OfAZoneThatNoSimulatedBlockReachesIsFiniteAndLarge) {
    Observable zone{"deposit zones", "-", {{Quantity::InZone, 0}}, true, false, true, {{0, 0, 5, 50}}};
    ObservationTable measured, simulated;
    measured.columns = simulated.columns = zone.columns;
    measured.values.resize(1);
    simulated.values = {std::vector<double>(1000, 0.0)};
    simulated.block.assign(1000, -1);
    const std::vector<double> scales{1.0};
    const Gap gap =
        compare_tables(measured, simulated, std::span(&zone, 1), scales, {200, 1, false}).observables[0].pooled;
    EXPECT_TRUE(std::isfinite(gap.gap));
    EXPECT_TRUE(gap.beyond_chance());
    EXPECT_GT(gap.gap, 100.0);
}

/// Stops, who passed a screen, and how fast: three views of the same blocks, which a block that runs far makes large together.
ObservationTable correlated_table(std::size_t blocks, std::size_t each, bool known, double shift,
                                  RandomStream& random) {
    ObservationTable table;
    table.columns = {{Quantity::Along, -1}, {Quantity::Passed, 0}, {Quantity::Speed, 0}};
    table.values.resize(3);
    for (std::size_t r = 0; r < each; ++r) {
        for (std::size_t b = 0; b < blocks; ++b) {
            const double along = (known ? 0.1 * static_cast<double>(b) : 0.0) + shift + random.normal();
            const bool passed = along > 0.5;
            table.block.push_back(known ? static_cast<std::int32_t>(b) : -1);
            table.values[0].push_back(along);
            table.values[1].push_back(passed ? 1.0 : 0.0);
            table.values[2].push_back(passed ? 3.0 + along + 0.3 * random.normal() : kNaN);
        }
    }
    return table;
}

/// With `missing`, only every second block that passed was filmed: its speed is then one of those that passed, and who passed counts for itself.
Account overall_tests(bool known, double shift, int repetitions, bool missing = false, std::size_t in_pool = 800) {
    constexpr std::size_t kBlocks = 40;
    Account account;
    for (int r = 0; r < repetitions; ++r) {
        RandomStream random = stream(7000 + static_cast<std::uint64_t>(r));
        const ObservationTable simulated =
            known ? correlated_table(kBlocks, 20, true, 0.0, random) : correlated_table(in_pool, 1, false, 0.0, random);
        ObservationTable measured = correlated_table(kBlocks, 1, known, shift, random);
        for (std::size_t b = 0; missing && b < kBlocks; b += 2) measured.values[2][b] = kNaN;
        std::vector<Observable> observables{
            {"along", "m", {{Quantity::Along, -1}}, false, known, true, {}},
            {"passing", "-", {{Quantity::Passed, 0}}, true, known, true, {}},
            {"speed", "m/s", {{Quantity::Speed, 0}}, false, known && !missing, true, {}}};
        const DiscrepancySettings settings{kDraws, static_cast<std::uint64_t>(r), false};
        account.add(compare_tables(measured, simulated, observables, column_scales(simulated), settings).overall, 1.0);
    }
    return account;
}

TEST(OverallGap, OfDependentObservablesIsOneUnderTheNullWithinItsIntervals) {
    for (const bool known : {true, false}) {
        const char* what = known ? "known blocks" : "pool";
        const Account account = overall_tests(known, 0.0, kRepetitions);
        const Moments gap = moments(account.gaps);
        EXPECT_NEAR(gap.mean, 1.0, kWide * gap.error) << what;
        expect_share(account.in_chance, kRepetitions, 0.95, what);
        expect_share(account.significant, kRepetitions, 0.05, what);
        EXPECT_GE(account.in_interval, 0.92 * kRepetitions) << what;
        EXPECT_GT(overall_tests(known, 0.8, 100).significant, 90) << what;
    }
}

// No more simulated than measured blocks: chance is known less well, but not as if nearly all of them were drawn and held against the rest.
TEST(OverallGap, OfAsManySimulatedAsMeasuredBlocksIsNearlyAtItsLevel) {
    const Account account = overall_tests(false, 0.0, kRepetitions, false, 40);
    EXPECT_NEAR(moments(account.gaps).mean, 1.0, 0.1);
    EXPECT_LT(account.significant, 0.09 * kRepetitions);
}

TEST(OverallGap, OfKnownBlocksOfWhichHalfWereFilmedIsOneUnderTheNull) {
    const Account account = overall_tests(true, 0.0, kRepetitions, true);
    const Moments gap = moments(account.gaps);
    EXPECT_NEAR(gap.mean, 1.0, kWide * gap.error);
    expect_share(account.in_chance, kRepetitions, 0.95, "half filmed");
    EXPECT_GT(overall_tests(true, 0.8, 100, true).significant, 90);
}

// --- what must not matter ---

TEST(Gap, DependsNeitherOnOrderNorOnUnits) {
    RandomStream random = stream(9);
    auto measured = draws(30, [&] { return 0.4 + random.normal(); });
    auto simulated = draws(900, [&] { return random.normal(); });
    const auto gap_of = [&](double unit) {
        auto m = measured, s = simulated;
        for (double& v : m) v *= unit;
        for (double& v : s) v *= unit;
        const std::vector<double> scales{1.0};
        return compare_tables(pool(m), pool(s), std::span(&kPooled, 1), scales, {100, 3, false}).observables[0].pooled;
    };
    const Gap metres = gap_of(1.0), millimetres = gap_of(1000.0);
    EXPECT_NEAR(millimetres.gap, metres.gap, 1e-9 * metres.gap);
    EXPECT_NEAR(millimetres.chance.high, metres.chance.high, 1e-9);
    EXPECT_NEAR(millimetres.distance, 1000.0 * metres.distance, 1e-6 * metres.distance);
    std::reverse(measured.begin(), measured.end());
    std::rotate(simulated.begin(), simulated.begin() + 311, simulated.end());
    EXPECT_NEAR(gap_of(1.0).gap, metres.gap, 1e-9 * metres.gap);
}

TEST(Gap, OfPointsDoesNotDependOnTheAxes) {
    // the energy distance in the plane is that of a rotated plane; in one column of zeros it is that of the line
    RandomStream random = stream(10);
    Observable plane = kPooled;
    plane.columns = {{Quantity::Along, -1}, {Quantity::Lateral, -1}};
    const auto table = [&](std::size_t n, double shift) {
        ObservationTable t;
        t.columns = plane.columns;
        t.values = {draws(n, [&] { return shift + 5.0 * random.normal(); }), draws(n, [&] { return random.normal(); })};
        t.block.assign(n, -1);
        return t;
    };
    ObservationTable measured = table(25, 3.0), simulated = table(400, 0.0);
    const std::vector<double> scales{1.0, 1.0};
    const auto gap = [&] {
        return compare_tables(measured, simulated, std::span(&plane, 1), scales, {100, 1, false}).observables[0].pooled;
    };
    const Gap before = gap();
    for (ObservationTable* t : {&measured, &simulated}) {
        for (std::size_t k = 0; k < t->rows(); ++k) {
            const double x = t->values[0][k], y = t->values[1][k];
            t->values[0][k] = 0.6 * x - 0.8 * y;
            t->values[1][k] = 0.8 * x + 0.6 * y;
        }
    }
    EXPECT_NEAR(gap().gap, before.gap, 1e-9 * before.gap);
    EXPECT_NEAR(gap().chance.high, before.chance.high, 1e-9);
    for (ObservationTable* t : {&measured, &simulated}) t->values[1].assign(t->rows(), 7.0);
    const Gap flat = gap();
    const Gap line =
        compare_tables(measured, simulated, std::span(&kPooled, 1), scales, {100, 1, false}).observables[0].pooled;
    EXPECT_NEAR(flat.gap, line.gap, 1e-9 * line.gap);
    EXPECT_NEAR(flat.interval.high, line.interval.high, 1e-9 * line.gap);
}

TEST(DistributionBand, HoldsTheBinomialQuantiles) {
    // n of many blocks: the number at or below x is binomial. At the median of the simulation, n = 40: 95 % of it lie in [14, 26] / 40
    RandomStream random = stream(11);
    ObservableSample sample;
    sample.simulated.values = draws(20'000, [&] { return random.uniform(); });
    sample.measured.values = draws(40, [&] { return random.uniform(); });
    sample.strata.resize(1);
    for (std::uint32_t k = 0; k < 20'000; ++k) sample.strata[0].push_back(k);
    const DistributionBand band = distribution_band(sample, 101, {4000, 1, false});
    EXPECT_NEAR(band.share[50], 0.5, 0.02);
    EXPECT_NEAR(band.low[50], 14.0 / 40.0, 0.026);
    EXPECT_NEAR(band.high[50], 26.0 / 40.0, 0.026);
    EXPECT_NEAR(band.share[90], 0.9, 0.02);
    EXPECT_NEAR(band.low[90], 32.0 / 40.0, 0.026);
    EXPECT_NEAR(band.high[90], 39.0 / 40.0, 0.026);
    for (std::size_t k = 1; k < band.x.size(); ++k) EXPECT_GE(band.share[k], band.share[k - 1]);
}

}  // namespace
}  // namespace scree
