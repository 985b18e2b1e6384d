// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ogr_spatialref.h>

#include <string>

namespace scree::test {

/// WKT2 of an EPSG code, as the reader of terrain hands it on.
inline std::string wkt2(int epsg) {
    OGRSpatialReference srs;
    srs.importFromEPSG(epsg);
    char* text = nullptr;
    const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
    srs.exportToWkt(&text, options);
    std::string out = text;
    CPLFree(text);
    return out;
}

}  // namespace scree::test
