// SPDX-License-Identifier: GPL-3.0-or-later
// This file is compiled once per instruction set: Highway includes it again for each and picks one when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/hull_kernels.cpp"
#include "geometry/hull_kernels.hpp"

#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, ConvexBlock::kLanes>;  // at most the lanes that the arrays are filled up to
using Lanes = hn::Vec<Tag>;

Lanes load(const Eigen::ArrayXd& a, Eigen::Index i) {
    return hn::LoadU(Tag(), a.data() + i);
}
Lanes load(const double* a, Eigen::Index i) {
    return hn::LoadU(Tag(), a + i);
}
Eigen::Index step() {
    return static_cast<Eigen::Index>(hn::Lanes(Tag()));
}

/// n.p for whole groups of points.
struct Dot {
    explicit Dot(const Vec3& n) : x(hn::Set(Tag(), n.x())), y(hn::Set(Tag(), n.y())), z(hn::Set(Tag(), n.z())) {}
    Lanes operator()(Lanes px, Lanes py, Lanes pz) const { return x * px + y * py + z * pz; }
    Lanes x, y, z;
};

double PlaneHeights(const ConvexBlock& block, const Vec3& n, double offset, double* height) {
    const Dot dot(n);
    const Lanes shift = hn::Set(Tag(), offset);
    Lanes least = hn::Set(Tag(), kInfinity);
    for (Eigen::Index i = 0; i < block.x.size(); i += step()) {
        const Lanes h = dot(load(block.x, i), load(block.y, i), load(block.z, i)) + shift;
        hn::StoreU(h, Tag(), height + i);
        least = hn::Min(least, h);
    }
    return hn::GetLane(hn::MinOfLanes(Tag(), least));
}

double Support(const ConvexBlock& block, const Vec3& n) {
    const Dot dot(n);
    Lanes most = hn::Set(Tag(), -kInfinity);
    for (Eigen::Index i = 0; i < block.x.size(); i += step())
        most = hn::Max(most, dot(load(block.x, i), load(block.y, i), load(block.z, i)));
    return hn::GetLane(hn::MaxOfLanes(Tag(), most));
}

/// When h + r t - a/2 t^2 first reaches zero, for h > 0; beyond the horizon if never.
Lanes Arrival(Lanes h, Lanes r, Lanes a, Lanes horizon) {
    const Lanes two_h = h + h, root = r * r + a * two_h;
    const Lanes fall = hn::Sqrt(hn::Max(root, hn::Zero(Tag()))) - r;
    const auto never = hn::Or(hn::Lt(root, hn::Zero(Tag())), hn::Le(fall, hn::Zero(Tag())));
    return hn::IfThenElse(never, horizon, hn::Min(two_h / fall, horizon));
}

// What the acceleration can be up to a guess of the time counts as constant up to then.
double SoonestArrival(const ConvexBlock& block, const double* height, const PlaneApproach& approach, double longest) {
    const Dot rate_of(approach.rate_vector), acceleration_of(approach.acceleration_vector);
    const Lanes rate = hn::Set(Tag(), approach.rate), acceleration = hn::Set(Tag(), approach.acceleration),
                jerk = hn::Set(Tag(), approach.jerk), most = hn::Set(Tag(), approach.most),
                horizon = hn::Set(Tag(), longest);
    Lanes soonest = horizon;
    for (Eigen::Index i = 0; i < block.x.size(); i += step()) {
        const Lanes x = load(block.x, i), y = load(block.y, i), z = load(block.z, i), h = load(height, i);
        const Lanes r = rate_of(x, y, z) + rate, a = acceleration_of(x, y, z) + acceleration;
        const Lanes guess = hn::Min(Arrival(h, r, a, horizon), horizon);
        soonest = hn::Min(soonest, hn::Min(guess, Arrival(h, r, hn::Min(a + jerk * guess, most), horizon)));
    }
    return hn::GetLane(hn::MinOfLanes(Tag(), soonest));
}

/// Least height of groups of vertices from now until a time: with an acceleration that counts as constant, and not as upwards, it is that at either end.
class LowestUntil {
public:
    LowestUntil(const ConvexBlock& block, const double* height, const PlaneApproach& approach, double time)
        : block_(block),
          height_(height),
          rate_of_(approach.rate_vector),
          acceleration_of_(approach.acceleration_vector),
          rate_(hn::Set(Tag(), approach.rate)),
          acceleration_(hn::Set(Tag(), approach.acceleration + approach.jerk * time)),
          most_(hn::Set(Tag(), approach.most)),
          time_(hn::Set(Tag(), time)),
          half_(hn::Set(Tag(), 0.5 * time)) {}
    Lanes operator()(Eigen::Index i) const {
        const Lanes x = load(block_.x, i), y = load(block_.y, i), z = load(block_.z, i), h = load(height_, i);
        const Lanes a = hn::Max(hn::Min(acceleration_of_(x, y, z) + acceleration_, most_), hn::Zero(Tag()));
        return hn::Min(h, h + time_ * (rate_of_(x, y, z) + rate_ - half_ * a));
    }

private:
    const ConvexBlock& block_;
    const double* height_;
    Dot rate_of_, acceleration_of_;
    Lanes rate_, acceleration_, most_, time_, half_;
};

/// Keeps the largest value of every lane and the first index where it is.
class FirstLargest {
public:
    FirstLargest() : most_(hn::Set(Tag(), -kInfinity)), where_(hn::Zero(Tag())), number_(hn::Iota(Tag(), 0.0)) {}
    void add(Lanes value) {
        const auto larger = hn::Gt(value, most_);
        most_ = hn::IfThenElse(larger, value, most_);
        where_ = hn::IfThenElse(larger, number_, where_);
        number_ = number_ + hn::Set(Tag(), static_cast<double>(step()));
    }
    double result(Eigen::Index& first) const {
        const Lanes most = hn::MaxOfLanes(Tag(), most_);
        const Lanes candidates = hn::IfThenElse(hn::Eq(most_, most), where_, hn::Set(Tag(), kInfinity));
        first = static_cast<Eigen::Index>(hn::GetLane(hn::MinOfLanes(Tag(), candidates)));
        return hn::GetLane(most);
    }

private:
    Lanes most_, where_, number_;
};

/// Numbers of the vertices that a condition on groups of them holds for.
template <class Condition>
std::size_t list_vertices(const ConvexBlock& block, Eigen::Index* vertices, const Condition& condition) {
    std::size_t count = 0;
    for (Eigen::Index i = 0; i < block.x.size(); i += step()) {
        const auto holds = condition(i);
        if (hn::AllFalse(Tag(), holds)) continue;
        HWY_ALIGN double each[ConvexBlock::kLanes];
        hn::Store(hn::IfThenElseZero(holds, hn::Set(Tag(), 1.0)), Tag(), each);
        for (Eigen::Index k = 0; k < step() && i + k < block.vertex_count(); ++k)
            if (each[k] != 0.0) vertices[count++] = i + k;
    }
    return count;
}

double LowestHeight(const ConvexBlock& block, const double* height, const PlaneApproach& approach, double time,
                    Eigen::Index& vertex) {
    const LowestUntil lowest(block, height, approach, time);
    FirstLargest deepest;
    for (Eigen::Index i = 0; i < block.x.size(); i += step()) deepest.add(hn::Neg(lowest(i)));
    return -deepest.result(vertex);
}

std::size_t VerticesReaching(const ConvexBlock& block, const double* height, const PlaneApproach& approach, double time,
                             Eigen::Index* vertices) {
    const LowestUntil lowest(block, height, approach, time);
    return list_vertices(block, vertices, [&](Eigen::Index i) { return hn::Le(lowest(i), hn::Zero(Tag())); });
}

std::size_t VerticesInReach(const ConvexBlock& block, const double* height, double most, const double* not_before,
                            double now, Eigen::Index* vertices) {
    const Lanes highest = hn::Set(Tag(), most), latest = hn::Set(Tag(), now);
    return list_vertices(block, vertices, [&](Eigen::Index i) {
        return hn::And(hn::Le(load(height, i), highest), hn::Le(load(not_before, i), latest));
    });
}

double FarthestFace(const ConvexBlock& block, const Vec3& p, Eigen::Index& face) {
    const Dot dot(p);
    FirstLargest farthest;
    for (Eigen::Index i = 0; i < block.nx.size(); i += step())
        farthest.add(dot(load(block.nx, i), load(block.ny, i), load(block.nz, i)) - load(block.offset, i));
    return farthest.result(face);
}

void FaceLines(const ConvexBlock& block, const Vec3& a, const Vec3& d, double* value, double* slope) {
    const Dot along_a(a), along_d(d);
    for (Eigen::Index i = 0; i < block.nx.size(); i += step()) {
        const Lanes x = load(block.nx, i), y = load(block.ny, i), z = load(block.nz, i);
        hn::StoreU(along_a(x, y, z) - load(block.offset, i), Tag(), value + i);
        hn::StoreU(along_d(x, y, z), Tag(), slope + i);
    }
}

double FarthestOnLine(const ConvexBlock& block, const double* value, const double* slope, double t,
                      Eigen::Index& face) {
    const Lanes place = hn::Set(Tag(), t);
    FirstLargest farthest;
    for (Eigen::Index i = 0; i < block.nx.size(); i += step()) farthest.add(load(value, i) + place * load(slope, i));
    return farthest.result(face);
}

double NextOnLine(const ConvexBlock& block, const double* value, const double* slope, double t, Eigen::Index face,
                  double direction, double room, Eigen::Index& next) {
    const Lanes place = hn::Set(Tag(), t), rise = hn::Set(Tag(), slope[face]),
                height = hn::Set(Tag(), value[face] + t * slope[face]);
    const Lanes sign = hn::Set(Tag(), direction), parallel = hn::Set(Tag(), 1e-12), here = hn::Set(Tag(), 1e-9),
                never = hn::Set(Tag(), kInfinity);
    FirstLargest nearest;
    for (Eigen::Index i = 0; i < block.nx.size(); i += step()) {
        const Lanes s = load(slope, i);
        const Lanes steeper = sign * (s - rise);
        const Lanes distance = (height - load(value, i) - place * s) / steeper;
        const auto counts = hn::And(hn::Gt(steeper, parallel), hn::Ge(distance, here));
        nearest.add(hn::Neg(hn::IfThenElse(counts, distance, never)));
    }
    Eigen::Index first = 0;
    const double distance = -nearest.result(first);
    if (!(distance < room)) return room;
    next = first;
    return distance;
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {

HWY_EXPORT(PlaneHeights);
HWY_EXPORT(Support);
HWY_EXPORT(SoonestArrival);
HWY_EXPORT(LowestHeight);
HWY_EXPORT(VerticesReaching);
HWY_EXPORT(VerticesInReach);
HWY_EXPORT(FarthestFace);
HWY_EXPORT(FaceLines);
HWY_EXPORT(FarthestOnLine);
HWY_EXPORT(NextOnLine);

double plane_heights(const ConvexBlock& block, const Vec3& n, double offset, double* height) {
    return HWY_DYNAMIC_DISPATCH(PlaneHeights)(block, n, offset, height);
}
double support(const ConvexBlock& block, const Vec3& n) {
    return HWY_DYNAMIC_DISPATCH(Support)(block, n);
}
double soonest_arrival(const ConvexBlock& block, const double* height, const PlaneApproach& approach, double horizon) {
    return HWY_DYNAMIC_DISPATCH(SoonestArrival)(block, height, approach, horizon);
}
double lowest_until(const ConvexBlock& block, const double* height, const PlaneApproach& approach, double time,
                    Eigen::Index& vertex) {
    return HWY_DYNAMIC_DISPATCH(LowestHeight)(block, height, approach, time, vertex);
}
std::size_t vertices_reaching(const ConvexBlock& block, const double* height, const PlaneApproach& approach,
                              double time, Eigen::Index* vertices) {
    return HWY_DYNAMIC_DISPATCH(VerticesReaching)(block, height, approach, time, vertices);
}
std::size_t vertices_in_reach(const ConvexBlock& block, const double* height, double most, const double* not_before,
                              double now, Eigen::Index* vertices) {
    return HWY_DYNAMIC_DISPATCH(VerticesInReach)(block, height, most, not_before, now, vertices);
}
double farthest_face(const ConvexBlock& block, const Vec3& p, Eigen::Index& face) {
    return HWY_DYNAMIC_DISPATCH(FarthestFace)(block, p, face);
}
void face_lines(const ConvexBlock& block, const Vec3& a, const Vec3& d, double* value, double* slope) {
    HWY_DYNAMIC_DISPATCH(FaceLines)(block, a, d, value, slope);
}
double farthest_on_line(const ConvexBlock& block, const double* value, const double* slope, double t,
                        Eigen::Index& face) {
    return HWY_DYNAMIC_DISPATCH(FarthestOnLine)(block, value, slope, t, face);
}
double next_on_line(const ConvexBlock& block, const double* value, const double* slope, double t, Eigen::Index face,
                    double direction, double room, Eigen::Index& next) {
    return HWY_DYNAMIC_DISPATCH(NextOnLine)(block, value, slope, t, face, direction, room, next);
}

}  // namespace scree
#endif
