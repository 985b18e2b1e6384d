// SPDX-License-Identifier: GPL-3.0-or-later
#include "ensemble/span_speed.hpp"

#include <algorithm>

namespace scree {

namespace {

/// Change of velocity between two segments that is an impact and not rounding, relative [-] and absolute [m/s].
constexpr double kJump = 1e-9;
constexpr int kBisections = 50;

/// Length of the path up to the share s: Simpson over the speed in two halves.
template <int Dim>
double length_to(const MotionSegment<Dim>& m, double s) {
    const double v[5] = {m.velocity_start.norm(), velocity_at(m, 0.25 * s).norm(), velocity_at(m, 0.5 * s).norm(),
                         velocity_at(m, 0.75 * s).norm(), velocity_at(m, s).norm()};
    return s * m.duration / 12.0 * (v[0] + 4.0 * v[1] + 2.0 * v[2] + 4.0 * v[3] + v[4]);
}

/// Share of a segment at which the path has the given length.
template <int Dim>
double share_at(const MotionSegment<Dim>& m, double length) {
    double low = 0.0, high = 1.0;
    for (int k = 0; k < kBisections; ++k) {
        const double middle = 0.5 * (low + high);
        (length_to(m, middle) < length ? low : high) = middle;
    }
    return high;
}

template <int Dim>
bool jumps(const MotionSegment<Dim>& before, const MotionSegment<Dim>& after) {
    return (after.velocity_start - before.velocity_end).norm() > kJump * (1.0 + before.velocity_end.norm());
}

template <class Vec>
void set_mean_speed(ScreenCrossing& crossing, const Vec& from, double since, const Vec& to, double until) {
    if (until > since) crossing.measured_speed = (to - from).norm() / (until - since);
}

}  // namespace

template <int Dim>
void SpanSpeed<Dim>::begin(const Fresh& fresh, const std::vector<ScreenCrossing>& crossings) {
    const Piece& newest = pieces_.back();
    const double here = newest.start + length_to(newest.motion, fresh.share);
    const double from = here - half_;
    const Piece* piece = &pieces_.front();
    for (const Piece& p : pieces_)
        if (p.start <= from) piece = &p;
    const double share = from <= piece->start ? 0.0 : share_at(piece->motion, from - piece->start);
    Pending pending;
    pending.crossing = fresh.crossing;
    pending.until = here + half_;
    pending.position = position_at(piece->motion, share);
    pending.time = piece->motion.start + share * piece->motion.duration;
    pending.free = !newest.motion.in_contact && last_touch_ < std::max(from, 0.0);
    if (pending.time < crossings[fresh.crossing].time) pending_.push_back(pending);
}

template <int Dim>
void SpanSpeed<Dim>::segment(const MotionSegment<Dim>& m, const std::vector<Fresh>& fresh,
                             std::vector<ScreenCrossing>& crossings) {
    if (half_ <= 0.0) return;
    const double start = pieces_.empty() ? 0.0 : pieces_.back().start + pieces_.back().length;
    const bool touches = m.in_contact || (!pieces_.empty() && jumps(pieces_.back().motion, m));
    pieces_.push_back({m, start, length_to(m, 1.0)});
    const double end = start + pieces_.back().length;
    while (pieces_.size() > 1 && pieces_.front().start + pieces_.front().length < start - half_) pieces_.pop_front();
    if (touches) {
        last_touch_ = m.in_contact ? end : start;
        for (Pending& p : pending_) p.free = p.free && p.until <= start;
    }
    for (const Fresh& f : fresh) begin(f, crossings);
    std::erase_if(pending_, [&](const Pending& p) {
        if (p.until > end) return false;
        const double share = share_at(m, p.until - start);
        if (!p.free)
            set_mean_speed(crossings[p.crossing], p.position, p.time, Vec(position_at(m, share)),
                           m.start + share * m.duration);
        return true;
    });
}

template <int Dim>
void SpanSpeed<Dim>::finish(std::vector<ScreenCrossing>& crossings) {
    for (const Pending& p : pending_) {
        const MotionSegment<Dim>& last = pieces_.back().motion;
        set_mean_speed(crossings[p.crossing], p.position, p.time, Vec(position_at(last, 1.0)),
                       last.start + last.duration);
    }
    pending_.clear();
}

template class SpanSpeed<2>;
template class SpanSpeed<3>;

}  // namespace scree
