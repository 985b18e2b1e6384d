// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/account.hpp"
#include "cli/campaign_layers.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/sweep_report.hpp"
#include "gis/results_writer.hpp"
#include "scree/base/random.hpp"
#include "scree/inference/distance.hpp"
#include "scree/inference/gap_function.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>

namespace scree::cli {

namespace {

namespace fs = std::filesystem;

/// The same measurements as a pool: which block is which is forgotten.
Observations pooled(Observations o) {
    o.matched = false;
    o.blocks.clear();
    for (ObservedStop& s : o.stops) s.block = -1;
    for (ObservedCrossing& c : o.crossings) c.block = -1;
    return o;
}

ObservationTable rows_where(const ObservationTable& table, const std::vector<char>& chosen, bool yes) {
    ObservationTable some{table.columns, std::vector<std::vector<double>>(table.columns.size()), {}};
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if ((chosen[row] != 0) != yes) continue;
        some.block.push_back(table.block[row]);
        for (std::size_t c = 0; c < table.values.size(); ++c) some.values[c].push_back(table.values[c][row]);
    }
    return some;
}

constexpr std::uint64_t kBaseSets = 100;  ///< drawn for what chance gives [-]

/// A measure with the column that it is the mean of.
struct MeasuredColumn {
    SweepMeasure measure;
    Column column;
    double factor = 1.0;  ///< to the unit that people read
};

double mean_of(const ObservationTable& table, const Column& column, std::size_t first, std::size_t last) {
    const std::size_t c = table.find(column);
    if (c == table.columns.size()) return kNaN;
    double sum = 0.0, n = 0.0;
    for (std::size_t row = first; row < std::min(last, table.rows()); ++row) {
        if (!std::isfinite(table.values[c][row])) continue;
        sum += table.values[c][row];
        n += 1.0;
    }
    return n > 0.0 ? sum / n : kNaN;
}

class Sweep {
public:
    Sweep(const Context& context, const SiteFile& site, const SiteModel& model, const ObservedSite& observed)
        : context_(context),
          site_(site),
          model_(model),
          observed_(observed),
          function_(pooled(observed.observations), observed.op),
          sets_(static_cast<std::size_t>(context.sets)) {
        for (const Observable& o : function_.observables())
            if (o.overall) study.observables.push_back(o.name);
        find_measures();
        study.title = site.settings.name;
        study.seed = site.settings.seed;
        study.sets = context.sets;
        for (const MeasuredColumn& m : measures_) study.measures.push_back(m.measure);
        blocks_ = std::max<std::int64_t>(
            {observed.observations.thrown, static_cast<std::int64_t>(observed.observations.blocks.size()), 2});
    }

    std::int64_t base_blocks() const { return blocks_; }

    /// False if it was stopped.
    bool run_base(CampaignResult& campaign) {
        if (!run(site_, model_, observed_, blocks_, campaign)) return false;
        base_ = function_.simulated(campaign, seed());
        study.base.blocks = blocks_;
        describe(study.base, function_.measured(), base_);
        study.base.influence = spread_over_sets(base_gaps(blocks_));
        study.base.told_apart = 0.05;
        return true;
    }

    /// Measurements are sorted to places once, and every value is judged by them. Throws InputError for a value with other ones.
    void require_same_places(const std::string& key, const std::string& value,
                             const std::vector<std::string>& fixed) const {
        std::vector<std::string> changes = fixed;
        changes.push_back(key + "=" + value);
        const SiteFile site = read_site_file(context_.target, changes);
        const SiteModel model = load_site(site);
        const ObservedSite observed = load_observed(site, model, context_.observed);
        const auto names = [](const SiteModel& of) {
            std::vector<std::string> all;
            for (const Screen& s : of.campaign.screens) all.push_back(s.name);
            return all;
        };
        const LocalFrame &frame = model.terrain.data.frame, &base = model_.terrain.data.frame;
        if (frame.easting != base.easting || frame.northing != base.northing ||
            observed.op.zones != observed_.op.zones || names(model) != names(model_))
            throw InputError("--set " + changes.back() +
                             ": gives other screens or deposit zones, or a terrain that begins at another corner, than "
                             "the site as it is, and what was measured would not be compared alike; run scree compare "
                             "on each");
    }

    bool run_value(const std::string& key, const std::string& value, const std::vector<std::string>& fixed) {
        std::vector<std::string> changes = fixed;
        changes.push_back(key + "=" + value);
        const SiteFile site = read_site_file(context_.target, changes);
        SweepValue v;
        v.key = key;
        v.value = value;
        v.blocks = key == "release.count" ? site.settings.releases.count : blocks_;
        const SiteModel model = load_site(site);
        const ObservedSite observed = load_observed(site, model, context_.observed);
        CampaignResult campaign;
        if (!run(site, model, observed, v.blocks, campaign)) return false;
        const GapFunction function(pooled(observed.observations), observed.op);  // the key may act on what is measured
        const ObservationTable table = function.simulated(campaign, seed());
        describe(v, function.measured(), table);
        judge(v, table);
        study.values.push_back(std::move(v));
        return true;
    }

    SweepStudy study;

private:
    std::uint64_t seed() const { return static_cast<std::uint64_t>(site_.settings.seed); }

    bool run(const SiteFile& site, const SiteModel& model, const ObservedSite& observed, std::int64_t blocks,
             CampaignResult& campaign) const {
        CampaignInput input = model.campaign;
        match_campaign(site, observed, input);
        if (&site != &site_)
            ++input.seed;  // other blocks than those of the site as it is, or they would stand among themselves
        input.release.count = blocks * context_.sets;
        input.threads = context_.threads;
        input.kept_trajectories = 0;
        campaign = run_campaign(
            input, [](std::int64_t) {}, InterruptScope::flag());
        return !campaign.interrupted;
    }

    /// Zone shares, then the mean of what was measured along the way.
    void find_measures() {
        const ObservationTable& measured = function_.measured();
        const auto add = [&](std::string name, const char* unit, const Column& column, double factor) {
            measures_.push_back(
                {{std::move(name), unit, factor * mean_of(measured, column, 0, measured.rows())}, column, factor});
        };
        for (const Observable& o : function_.observables()) {
            if (o.name == "deposit zones")
                for (const Column& c : o.columns) {
                    add(column_name(observed_.op, c), "%", c, 100.0);
                    for (const ObservedShare& s : o.counts)
                        if (o.columns[static_cast<std::size_t>(s.zone)] == c)
                            measures_.back().measure.measured =
                                100.0 * static_cast<double>(s.count) / static_cast<double>(s.thrown);
                }
            else if (!o.share && o.columns.size() == 1 && o.name != "runout" && o.name != "lateral")
                add(o.name + ", mean", o.unit == "J" ? "kJ" : o.unit.c_str(), o.columns[0], o.unit == "J" ? 1e-3 : 1.0);
        }
    }

    void describe(SweepValue& v, const ObservationTable& measured, const ObservationTable& table) const {
        const auto n = static_cast<std::size_t>(v.blocks);
        for (const MeasuredColumn& m : measures_) {
            std::vector<double> of_sets;
            for (std::size_t s = 0; s < sets_; ++s)
                of_sets.push_back(m.factor * mean_of(table, m.column, s * n, (s + 1) * n));
            v.measures.push_back(spread_over_sets(std::move(of_sets)));
        }
        v.gap = gap_between(measured, table, true);
    }

    double gap_between(const ObservationTable& some, const ObservationTable& others, bool counts) const {
        std::vector<Observable> observables = function_.observables();
        if (!counts)  // shares come from the rows of a set, not from what was counted in the test
            for (Observable& o : observables) o.counts.clear();
        DiscrepancySettings gaps_only;
        gaps_only.draws = 0;
        gaps_only.wasserstein = false;
        return compare_tables(some, others, observables, {}, gaps_only).overall.gap;
    }

    /// Rows of the site as it is that may stand for each other: those of one measured block, or all of them.
    std::vector<std::vector<std::size_t>> alike() const {
        const auto blocks = static_cast<std::size_t>(blocks_);
        const bool known = observed_.observations.matched && base_.rows() == blocks * sets_;  // none has failed
        std::vector<std::vector<std::size_t>> rows(known ? blocks : 1);
        for (std::size_t row = 0; row < base_.rows(); ++row) rows[row % rows.size()].push_back(row);
        return rows;
    }

    /// Gaps of sets of so many blocks of the site as it is to the rest of them: what chance gives. Sets are drawn from all its blocks, more often than
    /// there are sets of a value, or the limit would depend on which were the last of twenty; of known blocks as often each as a set of a value has it. None
    /// where a set is more than half of all.
    const std::vector<double>& base_gaps(std::int64_t blocks) {
        const auto known = base_gaps_.find(blocks);
        if (known != base_gaps_.end()) return known->second;
        std::vector<double>& gaps = base_gaps_[blocks];
        const auto n = static_cast<std::size_t>(blocks);
        for (std::uint64_t draw = 0; draw < kBaseSets && 2 * n <= base_.rows(); ++draw) {
            RandomStream random(seed(), draw, RandomPurpose::Resampling);
            std::vector<std::vector<std::size_t>> rows = alike();
            std::vector<char> chosen(base_.rows(), 0);
            for (std::size_t k = 0; k < n; ++k) {
                std::vector<std::size_t>& left = rows[k % rows.size()];
                std::swap(left[random.below(left.size())], left.back());
                chosen[left.back()] = 1;
                left.pop_back();
            }
            gaps.push_back(gap_between(rows_where(base_, chosen, true), rows_where(base_, chosen, false), false));
        }
        std::sort(gaps.begin(), gaps.end());
        return gaps;
    }

    void judge(SweepValue& v, const ObservationTable& table) {
        const auto n = static_cast<std::size_t>(v.blocks);
        std::vector<double> gaps;
        for (std::size_t s = 0; s < sets_ && s * n < table.rows(); ++s) {
            std::vector<char> chosen(table.rows(), 0);
            for (std::size_t row = s * n; row < std::min((s + 1) * n, table.rows()); ++row) chosen[row] = 1;
            gaps.push_back(gap_between(rows_where(table, chosen, true), base_, false));
        }
        v.influence = spread_over_sets(gaps);
        const std::vector<double>& own = base_gaps(v.blocks);
        if (own.empty() || gaps.empty()) return;
        const double limit = sample_quantile(own, 0.95);
        v.told_apart =
            static_cast<double>(std::count_if(gaps.begin(), gaps.end(), [&](double g) { return g > limit; })) /
            static_cast<double>(gaps.size());
    }

    const Context& context_;
    const SiteFile& site_;
    const SiteModel& model_;
    const ObservedSite& observed_;
    GapFunction function_;
    std::map<std::int64_t, std::vector<double>> base_gaps_;  ///< by the blocks of a set, ascending [-]
    std::size_t sets_;
    std::vector<MeasuredColumn> measures_;
    std::int64_t blocks_ = 0;
    ObservationTable base_;
};

}  // namespace

ExitCode run_sweep(const Context& context) {
    std::vector<std::string> fixed;
    const std::vector<SweptKey> keys = swept_keys(context.changes, fixed);
    const SiteFile site = read_site_file(context.target, fixed);
    for (const SweptKey& key : keys)  // what is not allowed is refused before anything is computed
        for (const std::string& value : key.values) {
            std::vector<std::string> changes = fixed;
            changes.push_back(key.key + "=" + value);
            read_site_file(context.target, changes);
        }
    fs::path folder = context.results_folder(site);
    if (context.output.empty()) folder += "_sweep";
    require_free_results(context, site, folder);
    const SiteModel model = load_site(site);
    const ObservedSite observed = load_observed(site, model, context.observed);
    gis::require_inputs_elsewhere(folder, model.files);
    gis::require_inputs_elsewhere(folder, observed.files);
    print_warnings(context, model.warnings);
    if (print_findings(context, observed)) return ExitCode::BadInput;

    Sweep sweep(context, site, model, observed);
    std::int64_t total = 1, done = 0;
    for (const SweptKey& key : keys) total += static_cast<std::int64_t>(key.values.size());
    const InterruptScope interrupt;
    Progress progress(context, "values", total);
    for (const SweptKey& key : keys)
        for (const std::string& value : key.values) sweep.require_same_places(key.key, value, fixed);
    CampaignResult base;
    bool whole = sweep.run_base(base);
    progress.update(++done);
    for (const SweptKey& key : keys)
        for (const std::string& value : key.values) {
            whole = whole && sweep.run_value(key.key, value, fixed);
            if (whole) progress.update(++done);
        }
    if (!whole) {
        *context.err << "interrupted: half a sweep misleads, nothing is written\n";
        return ExitCode::Interrupted;
    }
    progress.finish(done);

    gis::ResultsPackage package;
    package.frame = model.terrain.data.frame;
    package.title = site.settings.name + ": sweep, the site as it is";
    package.vectors = campaign_vectors(model, base);
    package.provenance = provenance(site, model, base);
    const Figure figure = sweep_figure(sweep.study);
    package.files = {{"figures/" + figure.file, figure.svg},
                     {"sweep.json", sweep_json(sweep.study)},
                     {"sweep.csv", sweep_csv(sweep.study)},
                     {"report.html", sweep_html(sweep.study, figure)}};
    gis::write_results(folder, package, context.overwrite);
    if (context.quiet) return ExitCode::Done;
    print_sweep(*context.out, sweep.study);
    *context.out << "report         " << (folder / "report.html").string()
                 << " (beside it sweep.csv, sweep.json, figures/sweep.svg)\n";
    return ExitCode::Done;
}

}  // namespace scree::cli
