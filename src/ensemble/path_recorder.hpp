// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ensemble/impact_watch.hpp"
#include "ensemble/span_speed.hpp"

#include "scree/ensemble/campaign.hpp"

#include <optional>
#include <unordered_map>
#include <vector>

namespace scree {

/// Follows the motion of one block: cells crossed with the largest values inside each, screens, length, a thinned line if wanted. What is cells and
/// screens on the map and along a profile is for the two recorders below to say. In plan view the path is a straight line within a segment (exact in
/// flight), so cells, facets and screens are met at exact times.
template <int Dim>
class PathRecorder : public MotionSink<Dim> {
public:
    using Vec = typename Space<Dim>::Vec;

    void segment(const MotionSegment<Dim>& motion) override;
    /// The trajectory has ended.
    void finish() {
        span_speed_.finish(crossings_);
        if (beyond_line_) keep_point(*beyond_line_, 1.0);  // where the block stopped
    }

    const std::unordered_map<std::size_t, CellValues>& cells() const { return cells_; }
    const std::vector<ScreenCrossing>& crossings() const { return crossings_; }
    const std::vector<FilmedImpact>& impacts() const { return impacts_; }
    KeptTrajectory take_line() { return std::move(line_); }

protected:
    PathRecorder(const CampaignInput& input, std::int64_t block, BlockResult& result);

    virtual void cross_cells(const MotionSegment<Dim>& m) = 0;
    virtual void cross_screens(const MotionSegment<Dim>& m) = 0;
    /// Largest height of the centre of mass above the ground between two shares of the segment.
    virtual double largest_height(const MotionSegment<Dim>& m, double from, double to) = 0;
    virtual double ground(const Vec& position) const = 0;
    /// Position or velocity on the map, for a place of the motion.
    virtual Vec3 on_map(const Vec& position) const = 0;
    virtual Vec3 velocity_on_map(const Vec& position, const Vec& velocity) const = 0;

    void raise_cell(std::size_t cell, const MotionSegment<Dim>& m, double from, double to);
    /// The screen that this line belongs to.
    std::size_t screen_of(std::size_t line) const {
        const std::int32_t other = input_.screens[line].part_of;
        return other < 0 ? line : static_cast<std::size_t>(other);
    }
    bool has_crossed(std::size_t line) const { return crossed_[screen_of(line)]; }
    struct Passed {
        std::size_t line;
        double share;  ///< of the segment [-]
    };
    /// Those that were not crossed before, in the order of the path.
    void add_crossings(std::vector<Passed>& passed, const MotionSegment<Dim>& m);

    const CampaignInput& input_;

private:
    FilmedImpact::End impact_end(const MotionSegment<Dim>& m, double share) const;
    void add_crossing(std::size_t screen, const MotionSegment<Dim>& m, double share);
    void keep_line(const MotionSegment<Dim>& m);
    void keep_point(const MotionSegment<Dim>& m, double share);

    std::int64_t block_;
    BlockResult& result_;
    std::unordered_map<std::size_t, CellValues> cells_;
    CellValues* last_values_ = nullptr;  ///< of the cell raised last
    std::size_t last_cell_ = 0;
    std::vector<ScreenCrossing> crossings_;
    std::vector<bool> crossed_;
    ImpactWatch<Dim> impact_watch_;
    std::vector<FilmedImpact> impacts_;
    SpanSpeed<Dim> span_speed_;
    std::vector<typename SpanSpeed<Dim>::Fresh> fresh_;  ///< crossings in the segment at hand
    bool keep_ = false;
    KeptTrajectory line_;
    std::optional<MotionSegment<Dim>> beyond_line_;  ///< the last one, if the line ends before it
};

/// On the map: cells of the result grid, screens as lines in plan.
class MapRecorder final : public PathRecorder<3> {
public:
    MapRecorder(const CampaignInput& input, std::int64_t block, BlockResult& result);

private:
    void cross_cells(const MotionSegment<3>& m) override;
    void cross_screens(const MotionSegment<3>& m) override;
    double largest_height(const MotionSegment<3>& m, double from, double to) override;
    double ground(const Vec3& position) const override { return input_.surface->height(position.head<2>()); }
    Vec3 on_map(const Vec3& position) const override { return position; }
    Vec3 velocity_on_map(const Vec3&, const Vec3& velocity) const override { return velocity; }

    /// A terrain triangle.
    struct Below {
        std::array<Vec3, 3> corner{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
        bool holds(const Vec2& p) const;
    };
    bool inside(const Vec2& p) const;

    std::vector<Box2> screen_boxes_;
    std::size_t cell_ = 0;  ///< raised last
    Box2 cell_box_;         ///< what it covers; empty: none yet
    Below below_;           ///< the facet below the centre of mass at the last look
};

/// Along a profile: cells of chainage, screens as chainages.
class ProfileRecorder final : public PathRecorder<2> {
public:
    ProfileRecorder(const CampaignInput& input, const ProfileTrack& track, const GroundLine& ground, std::int64_t block,
                    BlockResult& result);

private:
    void cross_cells(const MotionSegment<2>& m) override;
    void cross_screens(const MotionSegment<2>& m) override;
    double largest_height(const MotionSegment<2>& m, double from, double to) override;
    double ground(const Vec2& position) const override { return ground_.height(position.x()); }
    Vec3 on_map(const Vec2& position) const override;
    Vec3 velocity_on_map(const Vec2& position, const Vec2& velocity) const override;

    const ProfileTrack& track_;
    const GroundLine& ground_;
    std::size_t cell_count_;
};

}  // namespace scree
