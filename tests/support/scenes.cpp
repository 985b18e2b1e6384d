// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/scenes.hpp"

#include <Eigen/SVD>

#include <cmath>

namespace scree::test {

std::unique_ptr<Surface> grid_terrain(double half, double cell, const std::function<double(double, double)>& height) {
    GridShape shape;
    shape.columns = shape.rows = static_cast<int>(std::lround(2.0 * half / cell)) + 1;
    shape.cell = cell;
    shape.origin = Vec2::Constant(-half - 0.5 * cell);
    Grid<double> heights(shape);
    for (int j = 0; j < shape.rows; ++j)
        for (int i = 0; i < shape.columns; ++i)
            heights.at(i, j) = height(shape.centre(i, j).x(), shape.centre(i, j).y());
    std::vector<SoilId> soil(grid_facet_count(shape), 0);
    return make_grid_surface(std::move(heights), std::move(soil));
}

FramedBlock::FramedBlock(const std::vector<Vec3>& points, double mass) : block(make_block_from_points(points, mass)) {
    const ConvexHull hull = convex_hull(points);  // the block keeps the order of its vertices
    Eigen::Matrix3Xd from(3, hull.vertices.size()), to(3, hull.vertices.size());
    for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
        from.col(static_cast<Eigen::Index>(i)) = hull.vertices[i];
        to.col(static_cast<Eigen::Index>(i)) = block.vertex(i);
    }
    const Mat3 rotation = Eigen::umeyama(from, to, false).topLeftCorner<3, 3>();
    to_body = Quat(rotation).normalized();
}

}  // namespace scree::test
