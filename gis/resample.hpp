// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/dtm_reader.hpp"
#include "scree/geometry/grid.hpp"

#include <string>
#include <vector>

namespace scree::gis {

struct ResampleReport {
    double resolution = 0.0;  ///< edge length of the cells of the model [m]
    double rms_difference =
        0.0;  ///< root mean square of source height minus model surface at the source's cell centres [m]
    double max_difference = 0.0;    ///< largest absolute value of that difference [m]
    std::size_t source_nodata = 0;  ///< cells of the source without a height [-]
    std::size_t nodata = 0;         ///< cells of the model without a height [-]
    std::vector<std::string> warnings;
};

struct ResampledDtm {
    Grid<double> grid;  ///< heights at the cells' centres, local frame [m]; NaN: no value
    ResampleReport report;
};

/// Brings a terrain model to square cells of the given edge length [m], anchored at its north-west corner.
///
/// The height of a model cell is the weighted least-squares plane through the source cells that it overlaps, evaluated at its
/// centre; weights are overlap areas. Where the overlap is full and symmetric this is the area-weighted mean; everywhere, also
/// beside holes and for any ratio of cell sizes, a plane comes out as the same plane, so that slopes have no steps and no
/// half-cell shift. The overlap is taken with a window no smaller than a source cell: for a model finer than the source this
/// is bilinear interpolation between cell centres, for an equal one the identity.
///
/// A model cell has a height if at least half of its window's area has one in the source and the plane can be told there
/// without extrapolating (weights whose absolute values sum to at most 3); else NaN.
ResampledDtm resample(const Dtm& dtm, double resolution);

}  // namespace scree::gis
