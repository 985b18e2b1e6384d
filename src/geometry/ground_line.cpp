// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/ground_line.hpp"

#include "scree/base/error.hpp"
#include "scree/geometry/surface.hpp"

#include <cmath>

namespace scree {

GroundLine::GroundLine(const Profile& profile) {
    if (profile.empty()) throw InputError("a profile has fewer than two points: no block can move on it");
    const std::size_t count = profile.reach_count();
    reaches_.resize(count);
    crest_.assign(count, 0);
    for (std::size_t k = 0; k < count; ++k) {
        GroundReach& r = reaches_[k];
        const Vec2 a = profile.vertex(k), b = profile.vertex(k + 1);
        r.slope = (b.y() - a.y()) / (b.x() - a.x());
        r.normal = Vec2(-r.slope, 1.0).normalized();
        r.offset = r.normal.dot(a);
        r.from = a.x();
        r.to = b.x();
        r.start = a.y();
        r.soil = profile.soil[k];
        if (k == 0) continue;
        const Vec2 &before = reaches_[k - 1].normal, &after = r.normal;
        crest_[k] = cross(before, after) < -std::sin(kCrestAngle);
    }
    bins_.resize(count);
    bins_per_metre_ = static_cast<double>(count) / length();
    std::size_t k = 0;
    for (std::size_t bin = 0; bin < count; ++bin) {
        const double s = static_cast<double>(bin) / bins_per_metre_;
        while (k + 1 < count && reaches_[k].to < s) ++k;
        bins_[bin] = static_cast<std::uint32_t>(k);
    }
}

double GroundLine::height(double s) const {
    return contains(s) ? reaches_[reach_at(s)].height(s) : kNaN;
}

SupportingLine GroundLine::supporting_line(double from, double to) const {
    SupportingLine line;
    line.whole = from >= 0.0 && to <= length();
    from = std::max(from, 0.0);
    to = std::min(to, length());
    if (from > to) return line;
    const std::size_t first = reach_at(from), last = reach_at(to, first);
    const Vec2 a(from, reaches_[first].height(from)), b(to, reaches_[last].height(to));
    if (to > from) line.normal = Vec2(a.y() - b.y(), to - from).normalized();
    line.offset = std::max(line.normal.dot(a), line.normal.dot(b));
    for (std::size_t k = first + 1; k <= last; ++k) line.offset = std::max(line.offset, line.normal.dot(corner(k)));
    return line;
}

}  // namespace scree
