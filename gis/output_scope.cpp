// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/output_scope.hpp"

#include "scree/base/error.hpp"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

namespace scree::gis {

namespace {

/// Options of this thread while a scope lives. DELETE is SQLite's own default: a GeoPackage in WAL mode needs a writable folder
/// to be read. Durability comes from one flush at the end, when the file has its final name (see results_folder).
constexpr const char* kOptions[][2] = {{"OGR_CURRENT_DATE", kFixedTimestamp},
                                       {"OGR_SQLITE_JOURNAL", "DELETE"},
                                       {"OGR_SQLITE_SYNCHRONOUS", "OFF"},
                                       {"GDAL_PAM_ENABLED", "NO"}};

}  // namespace

OutputScope::OutputScope() {
    for (const auto& option : kOptions) CPLSetThreadLocalConfigOption(option[0], option[1]);
}

OutputScope::~OutputScope() {
    for (const auto& option : kOptions) CPLSetThreadLocalConfigOption(option[0], nullptr);
}

void OutputScope::check(const std::string& where, const std::string& sentence) const {
    if (!messages_.reason().empty()) fail(where, sentence);
}

void OutputScope::fail(const std::string& where, const std::string& sentence) const {
    throw ComputeError(where + ": " + sentence + messages_.reason());
}

void SpatialReferenceRelease::operator()(OGRSpatialReference* srs) const {
    srs->Release();
}

SpatialReference spatial_reference(const LocalFrame& frame) {
    if (frame.crs.empty()) return nullptr;
    SpatialReference srs(new OGRSpatialReference);
    if (srs->importFromWkt(frame.crs.c_str()) != OGRERR_NONE) {
        throw InputError("coordinate system of the results: PROJ does not understand \"" + frame.crs.substr(0, 60) +
                         "...\"; give a WKT that `projinfo` reads, or none");
    }
    srs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return srs;
}

SpatialReference geopackage_spatial_reference(const LocalFrame& frame) {
    if (!frame.crs.empty()) return spatial_reference(frame);
    SpatialReference srs(new OGRSpatialReference);
    srs->SetLocalCS("Undefined Cartesian SRS");  // the name that GDAL maps to srs_id -1
    return srs;
}

}  // namespace scree::gis
