// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/sweep_study.hpp"

#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

SetSpread spread_over_sets(std::vector<double> values) {
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
                 values.end());
    if (values.empty()) return {};
    const SampleSummary summary = summary_of(values);
    std::sort(values.begin(), values.end());
    return {summary.mean, summary.deviation, sample_quantile(values, 0.025), sample_quantile(values, 0.975)};
}

std::vector<SweptKey> swept_keys(const std::vector<std::string>& changes, std::vector<std::string>& fixed) {
    std::vector<SweptKey> keys;
    for (const std::string& change : changes) {
        const auto equals = change.find('=');
        const std::string text = change.substr(equals + 1);
        if (text.find(',') == std::string::npos || text.starts_with("[") || text.starts_with("\"")) {
            fixed.push_back(change);
            continue;
        }
        SweptKey key{change.substr(0, equals), {}};
        for (std::size_t begin = 0; begin <= text.size();) {
            const std::size_t end = std::min(text.find(',', begin), text.size());
            if (end == begin) throw InputError("--set " + change + " has an empty value between commas");
            key.values.push_back(text.substr(begin, end - begin));
            begin = end + 1;
        }
        keys.push_back(std::move(key));
    }
    if (keys.empty())
        throw InputError(
            "no key has several values: give one as --set KEY=v1,v2,..., such as --set release.height=1,2,4");
    return keys;
}

}  // namespace scree::cli
