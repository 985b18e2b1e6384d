// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/base/assert.hpp"
#include "scree/geometry/profile_trace.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace scree {

namespace {

/// The reaches of profiles in square bins.
class ReachIndex {
public:
    explicit ReachIndex(double distance) : distance_(distance), bin_(std::max(4.0 * distance, 1.0)) {}

    void add(int number, const Profile& profile) {
        for (std::size_t k = 0; k < profile.reach_count(); ++k) {
            Box2 box;
            box.add(profile.place[k]);
            box.add(profile.place[k + 1]);
            box = box.grown(distance_);
            for (int j = index(box.min.y()); j <= index(box.max.y()); ++j)
                for (int i = index(box.min.x()); i <= index(box.max.x()); ++i)
                    bins_[{i, j}].push_back({number, profile.place[k], profile.place[k + 1]});
        }
    }

    /// Number of the nearest profile within the distance of p, the earliest of those equally near; -1 if there is none.
    int near(const Vec2& p) const {
        const auto bin = bins_.find({index(p.x()), index(p.y())});
        if (bin == bins_.end()) return -1;
        int best = -1;
        double least = distance_;
        for (const Reach& reach : bin->second) {
            const Vec2 along = reach.b - reach.a;
            const double u = std::clamp((p - reach.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
            const double distance = (p - reach.a - u * along).norm();
            if (distance > least || (distance == least && best >= 0 && best <= reach.number)) continue;
            least = distance;
            best = reach.number;
        }
        return best;
    }

private:
    struct Reach {
        int number;
        Vec2 a, b;  // [m]
    };
    int index(double x) const { return static_cast<int>(std::floor(x / bin_)); }

    double distance_, bin_;  // [m]
    std::map<std::pair<int, int>, std::vector<Reach>> bins_;
};

/// First vertex from which on all are near earlier profiles; the number of vertices if the last one is not.
std::size_t junction_of(const Profile& profile, const ReachIndex& earlier) {
    std::size_t k = profile.vertex_count();
    while (k > 0 && earlier.near(profile.place[k - 1]) >= 0) --k;
    return k;
}

void cut_at(ProfileTrace& trace, std::size_t vertex) {
    Profile& p = trace.profile;
    p.s.resize(vertex + 1);
    p.z.resize(vertex + 1);
    p.place.resize(vertex + 1);
    p.soil.resize(vertex);
    trace.course.resize(vertex);
    trace.end = ProfileEnd::Merged;
}

}  // namespace

std::size_t find_junctions(std::vector<ProfileTrace>& traces, double distance, Converging converging) {
    SCREE_ASSERT(distance > 0.0);
    ReachIndex earlier(distance);
    std::vector<ProfileTrace> kept;
    for (ProfileTrace& trace : traces) {
        Profile& p = trace.profile;
        const std::size_t at = junction_of(p, earlier);
        // a last point alone is no junction: two lines may end side by side
        if (!p.empty() && at + 1 < p.vertex_count()) {
            trace.joins = earlier.near(p.place[at]);
            trace.joins_at = p.s[at];
            if (converging == Converging::Drop && p.length() - p.s[at] > 0.5 * p.length()) continue;
            if (converging == Converging::Merge && at == 0) continue;  // nothing of its own
            if (converging == Converging::Merge) cut_at(trace, at);
        }
        earlier.add(static_cast<int>(kept.size()), p);
        kept.push_back(std::move(trace));
    }
    const std::size_t left_out = traces.size() - kept.size();
    traces = std::move(kept);
    return left_out;
}

}  // namespace scree
