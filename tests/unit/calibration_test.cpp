// SPDX-License-Identifier: GPL-3.0-or-later
// The course of a calibration: which simulations it asks for, what it keeps, how it resumes, and what it refuses.
#include "scree/inference/calibration.hpp"

#include "scree/base/error.hpp"
#include "scree/base/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

namespace scree {
namespace {

constexpr std::size_t kRecords = 20;

/// Two numbers and a choice. Record k is least at (2 + c_k, 0.03) with c_k of mean zero; "round" costs 0.5 more.
CalibrationProblem two_and_a_choice() {
    CalibrationProblem problem;
    problem.parameters = {{"height", 1.0, 4.0, 3.5, false}, {"rolling", 0.001, 1.0, 0.5, true}};
    problem.choices = {{"shape", {"hull", "round"}, 1}};
    problem.records = kRecords;
    return problem;
}

std::optional<SimulatedLoss> bowl(const CalibrationTask& task) {
    SimulatedLoss result;
    for (std::size_t k = 0; k < kRecords; ++k) {
        RandomStream random(task.seed, k, RandomPurpose::Effect);
        const double own = 0.4 * (static_cast<double>(k) / (kRecords - 1) - 0.5);
        const double h = task.point.values[0] - 2.0 - own, r = std::log10(task.point.values[1] / 0.03);
        const double noise = 0.1 * random.normal() / std::sqrt(static_cast<double>(task.repeats));
        result.loss.push_back(1.0 + h * h + 0.5 * r * r + (task.point.levels[0] == 1 ? 0.5 : 0.0) + noise);
        result.floor.push_back(1.0);
    }
    return result;
}

CalibrationSettings quick() {
    CalibrationSettings settings;
    settings.draws = 300;
    return settings;
}

TEST(Calibration, FindsTheMinimumAndTheBetterChoice) {
    CalibrationJournal journal;
    const CalibrationResult r = calibrate(two_and_a_choice(), quick(), bowl, journal, nullptr);
    EXPECT_FALSE(r.interrupted);
    EXPECT_EQ(r.best.levels, std::vector<std::size_t>{0});
    EXPECT_NEAR(r.best.values[0], 2.0, 0.1);
    EXPECT_NEAR(std::log10(r.best.values[1] / 0.03), 0.0, 0.15);
    EXPECT_NEAR(r.best_fit.loss, 1.0 + 0.16 / 12.0 * 21.0 / 19.0, 0.05);  // the variance of c_k is left
    EXPECT_GT(r.start_fit.gap(), 2.0);
    ASSERT_EQ(r.searches.size(), 2U);
    EXPECT_EQ(r.searches[0].end.levels, std::vector<std::size_t>{0});
    EXPECT_TRUE(std::isnan(r.searches[0].behind.low));
    EXPECT_GT(r.searches[1].behind.low, 0.2);  // by 0.5, and what two searches differ
    EXPECT_TRUE(r.searches[0].same_minimum);
    EXPECT_FALSE(r.searches[1].same_minimum);
    for (const ParameterEstimate& e : r.parameters) {
        EXPECT_EQ(e.identified, Identification::Well);
        EXPECT_FALSE(e.at_low || e.at_high);
        EXPECT_LE(e.interval.low, e.value);
        EXPECT_GE(e.interval.high, e.value);
    }
    EXPECT_EQ(r.draws.size(), 300U);
    EXPECT_GT(r.surroundings.explained, 0.9);
}

TEST(Calibration, CommonRandomNumbersInsideAGenerationFreshOnesBetween) {
    CalibrationJournal journal;
    const CalibrationProblem problem = two_and_a_choice();
    CalibrationSettings settings = quick();
    settings.population = 6;
    settings.generations = 4;
    std::vector<CalibrationProgress> told;
    calibrate(problem, settings, bowl, journal, [&](const CalibrationProgress& p) { told.push_back(p); });
    ASSERT_EQ(journal.size(), planned_evaluations(problem, settings));
    EXPECT_EQ(told.size(), journal.size());
    EXPECT_EQ(told.back().done, told.back().planned);

    std::map<CalibrationStage, std::map<std::uint64_t, std::size_t>> uses;  // of seeds
    for (const CalibrationEvaluation& e : journal) ++uses[e.task.stage][e.task.seed];
    EXPECT_EQ(uses[CalibrationStage::Screening].size(), 1U);  // also across the levels
    EXPECT_EQ(uses[CalibrationStage::Search].size(), 2U * 4U);
    for (const auto& [seed, count] : uses[CalibrationStage::Search]) EXPECT_EQ(count, 6U) << seed;
    EXPECT_EQ(uses[CalibrationStage::Race].size(), 3U);
    for (const auto& [seed, count] : uses[CalibrationStage::Race])
        EXPECT_EQ(count, 6U) << seed;  // end, best point seen and beginning of both searches
    for (const auto& [seed, count] : uses[CalibrationStage::Surroundings]) EXPECT_EQ(count, 1U) << seed;
    EXPECT_EQ(uses[CalibrationStage::Judgement].size(), 1U);
    std::set<std::uint64_t> all;
    std::size_t sum = 0;
    for (const auto& [stage, seeds] : uses) {
        sum += seeds.size();
        for (const auto& [seed, count] : seeds) all.insert(seed);
    }
    EXPECT_EQ(all.size(), sum);  // no stage shares its luck with another
}

TEST(Calibration, ResumesWithTheSameResultAndNothingRunTwice) {
    CalibrationJournal whole;
    const CalibrationResult expected = calibrate(two_and_a_choice(), quick(), bowl, whole, nullptr);
    for (const std::size_t kept : {std::size_t{1}, whole.size() / 3, whole.size() - 1}) {
        CalibrationJournal journal;
        const LossFunction stops = [&](const CalibrationTask& task) {
            return journal.size() < kept ? bowl(task) : std::nullopt;
        };
        const CalibrationResult stopped = calibrate(two_and_a_choice(), quick(), stops, journal, nullptr);
        EXPECT_TRUE(stopped.interrupted);
        EXPECT_EQ(journal.size(), kept);
        std::size_t calls = 0;
        const LossFunction counts = [&](const CalibrationTask& task) {
            ++calls;
            return bowl(task);
        };
        const CalibrationResult resumed = calibrate(two_and_a_choice(), quick(), counts, journal, nullptr);
        EXPECT_EQ(calls, whole.size() - kept);
        EXPECT_EQ(resumed.best, expected.best);
        EXPECT_EQ(resumed.draws, expected.draws);
        EXPECT_EQ(resumed.held_out.loss, expected.held_out.loss);
    }
}

TEST(Calibration, RefusesAJournalOfAnotherCalibration) {
    CalibrationJournal journal;
    calibrate(two_and_a_choice(), quick(), bowl, journal, nullptr);
    CalibrationSettings other = quick();
    other.search_repeats = 7;
    EXPECT_THAT([&] { calibrate(two_and_a_choice(), other, bowl, journal, nullptr); },
                ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("simulation 1")));
}

TEST(Calibration, SaysWhenTheMinimumLiesOnTheEdgeOrNowhere) {
    CalibrationProblem problem;
    problem.parameters = {{"restitution", 0.0, 1.0, 0.5, false}, {"unused", 0.0, 1.0, kNaN, false}};
    problem.records = kRecords;
    const LossFunction slope = [](const CalibrationTask& task) {
        SimulatedLoss result;
        for (std::size_t k = 0; k < kRecords; ++k) {
            RandomStream random(task.seed, k, RandomPurpose::Effect);
            result.loss.push_back(2.0 + 3.0 * task.point.values[0] + 0.2 * random.normal());
            result.floor.push_back(1.0);
        }
        return std::optional(result);
    };
    CalibrationJournal journal;
    const CalibrationResult r = calibrate(problem, quick(), slope, journal, nullptr);
    EXPECT_TRUE(r.parameters[0].at_low);
    EXPECT_EQ(r.parameters[0].identified, Identification::Well);
    EXPECT_NEAR(r.parameters[0].value, 0.0, 1e-9);
    EXPECT_EQ(r.parameters[1].identified, Identification::Not);
    // and the direction that is known worst is that of the unused one
    EXPECT_GT(std::abs(r.directions.back().weights[1]), 0.99);
}

TEST(Calibration, FoldsCoverEveryRecordOnce) {
    CalibrationJournal journal;
    const CalibrationResult r = calibrate(two_and_a_choice(), quick(), bowl, journal, nullptr);
    ASSERT_EQ(r.folds.size(), 5U);
    std::vector<int> held(kRecords, 0);
    for (const CalibrationFold& fold : r.folds)
        for (const std::size_t k : fold.held_out) ++held[k];
    EXPECT_EQ(held, std::vector<int>(kRecords, 1));
    EXPECT_GT(r.held_out_start.loss, r.held_out.loss + 1.0);
}

TEST(Calibration, KeepsWhatEveryRecordLosesHeldOut) {
    CalibrationJournal journal;
    const CalibrationResult r = calibrate(two_and_a_choice(), quick(), bowl, journal, nullptr);
    ASSERT_EQ(r.held_out_losses.size(), kRecords);
    double mean = 0.0;
    for (const double loss : r.held_out_losses) mean += loss / kRecords;
    EXPECT_NEAR(mean, r.held_out.loss, 1e-12);
    for (const CalibrationFold& f : r.folds) {
        double of_fold = 0.0;
        for (const std::size_t k : f.held_out) of_fold += r.held_out_losses[k] / static_cast<double>(f.held_out.size());
        EXPECT_NEAR(of_fold, f.test.loss, 1e-12);
    }
}

TEST(Calibration, SaysWhenAllFoldsChooseWhatAllRecordsChoose) {
    CalibrationJournal journal, other;
    EXPECT_FALSE(calibrate(two_and_a_choice(), quick(), bowl, journal, nullptr).held_out_was_seen);
    // a hole at the first point, of which no quadratic knows: whichever records are asked, it is the best
    const auto hole = [](const CalibrationTask& task) {
        std::optional<SimulatedLoss> result = bowl(task);
        const bool at_start = std::abs(task.point.values[0] - 3.5) < 1e-9 && task.point.levels[0] == 1;
        for (double& loss : result->loss) loss = at_start ? 0.1 : loss + 1.0;
        return result;
    };
    const CalibrationResult r = calibrate(two_and_a_choice(), quick(), hole, other, nullptr);
    EXPECT_TRUE(r.held_out_was_seen);
    EXPECT_DOUBLE_EQ(r.held_out.loss, r.best_fit.loss);
}

// Two places that ask for different values: the calibration lies between, and what is left out is predicted by what the other one asks for.
TEST(Calibration, LeavesOutEveryPlaceOnce) {
    CalibrationProblem problem;
    problem.parameters = {{"x", 0.0, 10.0, 5.0, false}};
    problem.records = kRecords;
    problem.places = {"stops", "screen"};
    const LossFunction two_places = [](const CalibrationTask& task) {
        SimulatedLoss result;
        const std::vector<double> none(kRecords, 0.0);
        result.loss = none;
        result.floor = std::vector<double>(kRecords, 1.0);
        result.loss_at = {none, none};
        result.floor_at = {std::vector<double>(kRecords, 0.5), std::vector<double>(kRecords, 0.5)};
        for (std::size_t place = 0; place < 2; ++place)
            for (std::size_t k = 0; k < kRecords; ++k) {
                RandomStream random(task.seed, 2 * k + place, RandomPurpose::Effect);
                const double off = task.point.values[0] - (place == 0 ? 4.0 : 6.0);
                const double own = 0.5 + off * off + 0.02 * random.normal();
                result.loss_at[place][k] = own;
                result.loss[k] += own;
            }
        return std::optional(result);
    };
    CalibrationJournal journal;
    std::size_t planned = 0;
    const CalibrationResult r =
        calibrate(problem, quick(), two_places, journal, [&](const CalibrationProgress& p) { planned = p.planned; });
    EXPECT_EQ(journal.size(), planned);
    EXPECT_NEAR(r.best.values[0], 5.0, 0.1);
    ASSERT_EQ(r.places.size(), 2U);
    const double asked[] = {4.0, 6.0};
    for (std::size_t p = 0; p < 2; ++p) {
        EXPECT_EQ(r.places[p].name, problem.places[p]);
        EXPECT_FALSE(r.places[p].is_path);
        EXPECT_TRUE(std::isfinite(r.places[p].start.loss));
        EXPECT_NEAR(r.places[p].point.values[0], asked[1 - p], 0.1);
        EXPECT_NEAR(r.places[p].training.loss, 0.5, 0.05);
        EXPECT_NEAR(r.places[p].test.loss, 0.5 + 4.0, 0.4);
        EXPECT_NEAR(r.places[p].best.loss, 0.5 + 1.0, 0.25);
        EXPECT_NEAR(r.places[p].held_out.loss, 0.5 + 1.0, 0.25);
        EXPECT_NEAR(r.places[p].test.gap(), r.places[p].test.loss / 0.5, 1e-9);
    }
    // one place leaves nothing to predict it by
    problem.places = {"stops"};
    const LossFunction one_place = [&](const CalibrationTask& task) {
        auto result = two_places(task);
        result->loss_at.resize(1);
        result->floor_at.resize(1);
        return result;
    };
    CalibrationJournal another;
    EXPECT_TRUE(calibrate(problem, quick(), one_place, another, nullptr).places.empty());
}

// Blocks of two paths that ask for different values: what is left out is predicted by the blocks of the other path, whatever place they were seen at.
TEST(Calibration, LeavesOutEveryPathOnce) {
    CalibrationProblem problem;
    problem.parameters = {{"x", 0.0, 10.0, 5.0, false}};
    problem.records = kRecords;
    CalibrationPath east{"east", {}}, west{"west", {}};
    for (std::size_t k = 0; k < kRecords; ++k) (k % 4 == 0 ? east : west).records.push_back(k);
    problem.paths = {east, west};
    const LossFunction two_paths = [](const CalibrationTask& task) {
        SimulatedLoss result;
        for (std::size_t k = 0; k < kRecords; ++k) {
            RandomStream random(task.seed, k, RandomPurpose::Effect);
            const double off = task.point.values[0] - (k % 4 == 0 ? 3.0 : 7.0);
            result.loss.push_back(0.5 + off * off + 0.02 * random.normal());
            result.floor.push_back(0.5);
        }
        return std::optional(result);
    };
    CalibrationJournal journal;
    std::size_t planned = 0;
    const CalibrationResult r =
        calibrate(problem, quick(), two_paths, journal, [&](const CalibrationProgress& p) { planned = p.planned; });
    EXPECT_EQ(journal.size(), planned);
    EXPECT_NEAR(r.best.values[0], 6.0, 0.1);  // a quarter of the blocks goes east
    ASSERT_EQ(r.places.size(), 2U);
    EXPECT_EQ(r.places[0].name, "east");
    EXPECT_EQ(r.places[1].name, "west");
    EXPECT_TRUE(r.places[0].is_path);
    EXPECT_FALSE(r.places[0].was_seen);
    EXPECT_NEAR(r.places[0].start.loss, 0.5 + 4.0, 0.3);  // at 5
    EXPECT_NEAR(r.places[0].point.values[0], 7.0, 0.1);
    EXPECT_NEAR(r.places[1].point.values[0], 3.0, 0.3);
    for (const CalibrationPlace& left : r.places) {
        EXPECT_NEAR(left.training.loss, 0.5, 0.15);
        EXPECT_NEAR(left.test.loss, 0.5 + 16.0, 2.0);
    }
    EXPECT_NEAR(r.places[0].best.loss, 0.5 + 9.0, 0.7);
    EXPECT_NEAR(r.places[1].best.loss, 0.5 + 1.0, 0.3);
    double east_held_out = 0.0;
    for (const std::size_t k : east.records)
        east_held_out += r.held_out_losses[k] / static_cast<double>(east.records.size());
    EXPECT_NEAR(r.places[0].held_out.loss, east_held_out, 1e-12);
    EXPECT_NEAR(r.places[0].held_out.floor, 0.5, 1e-12);

    problem.paths = {east};  // nobody knows where the others went: that is one path
    CalibrationJournal another;
    EXPECT_TRUE(calibrate(problem, quick(), two_paths, another, nullptr).places.empty());
}

TEST(Calibration, ChoicesAloneAreRaced) {
    CalibrationProblem problem = two_and_a_choice();
    problem.parameters.clear();
    const LossFunction function = [](const CalibrationTask& task) {
        CalibrationTask full = task;
        full.point.values = {2.0, 0.03};
        return bowl(full);
    };
    CalibrationJournal journal;
    const CalibrationResult r = calibrate(problem, quick(), function, journal, nullptr);
    EXPECT_EQ(r.best.levels, std::vector<std::size_t>{0});
    EXPECT_GT(r.searches[1].behind.low, 0.4);
    EXPECT_EQ(journal.size(), planned_evaluations(problem, quick()));
}

TEST(Calibration, GoesAroundWhereNothingCanBeSaid) {
    const LossFunction patchy = [](const CalibrationTask& task) {
        return task.point.values[0] > 3.0 ? std::optional(SimulatedLoss{}) : bowl(task);
    };
    CalibrationJournal journal;
    const CalibrationResult r = calibrate(two_and_a_choice(), quick(), patchy, journal, nullptr);
    EXPECT_NEAR(r.best.values[0], 2.0, 0.1);
    const LossFunction nothing = [](const CalibrationTask&) { return std::optional(SimulatedLoss{}); };
    CalibrationJournal empty;
    EXPECT_THROW(calibrate(two_and_a_choice(), quick(), nothing, empty, nullptr), InputError);
}

// What is held against each other is searched with the same effort.
TEST(Calibration, OneBudgetServesModelsWithMoreAndFewerParameters) {
    CalibrationProblem fewer = two_and_a_choice(), more = fewer;
    more.parameters.push_back({"strength", 0.0, 1.0, 0.5, false});
    EXPECT_LT(planned_evaluations(fewer, {}), planned_evaluations(more, {}));
    const CalibrationSettings decided = with_budget_of({}, 3);
    EXPECT_EQ(planned_evaluations(fewer, decided), planned_evaluations(more, decided));
    EXPECT_EQ(planned_evaluations(more, decided), planned_evaluations(more, {}));
    CalibrationSettings set;
    set.screening = 11;
    EXPECT_EQ(with_budget_of(set, 3).screening, 11) << "what somebody has set stays";
}

TEST(Calibration, RefusesProblemsThatMakeNoSense) {
    CalibrationJournal journal;
    const auto refuses = [&](const CalibrationProblem& problem, const char* what) {
        EXPECT_THAT([&] { calibrate(problem, quick(), bowl, journal, nullptr); },
                    ::testing::ThrowsMessage<InputError>(::testing::HasSubstr(what)));
    };
    CalibrationProblem p = two_and_a_choice();
    p.records = 1;
    refuses(p, "at least two measured blocks");
    p = two_and_a_choice();
    p.parameters[0].high = 1.0;
    refuses(p, "height is empty");
    p = two_and_a_choice();
    p.parameters[1].low = 0.0;
    refuses(p, "must begin above 0");
    p = two_and_a_choice();
    p.parameters[0].start = 5.0;
    refuses(p, "lies outside its range");
    p = {};
    p.records = 5;
    refuses(p, "at least one free parameter");
}

}  // namespace
}  // namespace scree
