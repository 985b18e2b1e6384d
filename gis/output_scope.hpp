// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/dataset.hpp"
#include "gis/gdal_scope.hpp"
#include "scree/geometry/local_frame.hpp"

#include <memory>
#include <string>

class OGRSpatialReference;

namespace scree::gis {

/// The moment that stands in every file where a format demands one (gpkg_contents.last_change). It is the same for every run:
/// the same input gives the same bytes. When a run happened belongs to its provenance, if anywhere.
inline constexpr const char* kFixedTimestamp = "2000-01-01T00:00:00.000Z";

/// What every writing of a file through GDAL needs while it lasts: the collected messages, the fixed timestamp, no journals left
/// behind and no .aux.xml beside the files.
class OutputScope {
public:
    OutputScope();
    ~OutputScope();
    OutputScope(const OutputScope&) = delete;
    OutputScope& operator=(const OutputScope&) = delete;

    /// Throws ComputeError "WHERE: SENTENCE; GDAL says: ..." if an error was collected, even where the call that failed returned
    /// nothing (closing a data set, writing the last tiles).
    void check(const std::string& where, const std::string& sentence) const;
    [[noreturn]] void fail(const std::string& where, const std::string& sentence) const;

private:
    GdalScope messages_;
};

struct SpatialReferenceRelease {
    void operator()(OGRSpatialReference* srs) const;
};
using SpatialReference = std::unique_ptr<OGRSpatialReference, SpatialReferenceRelease>;

/// The frame's CRS with easting first. Null where the frame has none. Throws InputError if PROJ does not understand it.
SpatialReference spatial_reference(const LocalFrame& frame);

/// As for a GeoPackage: where the frame has no CRS, the one that the standard calls undefined Cartesian (-1).
SpatialReference geopackage_spatial_reference(const LocalFrame& frame);

}  // namespace scree::gis
