// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ensemble/span_speed.hpp"

#include "scree/ensemble/campaign.hpp"

#include <unordered_map>
#include <vector>

namespace scree {

/// Follows the motion of one block: cells crossed with the largest values inside each, screens, length, a thinned line if wanted.
/// In plan view the path is a straight line within a segment (exact in flight), so cells, facets and screens are met at exact times.
class PathRecorder final : public MotionSink<3> {
public:
    PathRecorder(const CampaignInput& input, std::int64_t block, double mass, BlockResult& result);

    void segment(const MotionSegment<3>& motion) override;
    /// The trajectory has ended.
    void finish() { span_speed_.finish(crossings_); }

    const std::unordered_map<std::size_t, CellValues>& cells() const { return cells_; }
    const std::vector<ScreenCrossing>& crossings() const { return crossings_; }
    KeptTrajectory take_line() { return std::move(line_); }

private:
    void cross_cells(const MotionSegment<3>& m);
    void enter_cell(const MotionSegment<3>& m, const Vec2& middle, double from, double to);
    double largest_height(const MotionSegment<3>& m, double from, double to) const;
    void cross_screens(const MotionSegment<3>& m);
    void keep_line(const MotionSegment<3>& m);

    const CampaignInput& input_;
    std::int64_t block_;
    double mass_;  ///< [kg]
    BlockResult& result_;
    std::unordered_map<std::size_t, CellValues> cells_;
    std::vector<ScreenCrossing> crossings_;
    std::vector<bool> crossed_;
    std::vector<Box2> screen_boxes_;
    SpanSpeed span_speed_;
    std::vector<SpanSpeed::Fresh> fresh_;  ///< crossings in the segment at hand
    bool keep_ = false;
    KeptTrajectory line_;
};

}  // namespace scree
