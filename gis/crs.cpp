// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/crs.hpp"

#include "gis/gdal_scope.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <geodesic.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

namespace scree::gis {

namespace {

// Distances on the map that differ from those on the ground by more than this are refused, or warned of [-]. National grids stay
// below 0.1 %, continental ones below 1 %; Web Mercator has 50 % at 47 degrees.
constexpr double kScaleErrorRefused = 0.02;
constexpr double kScaleErrorWarned = 0.003;

std::string crs_name(const OGRSpatialReference& crs) {
    const char* name = crs.GetName();
    const char* authority = crs.GetAuthorityName(nullptr);
    const char* code = crs.GetAuthorityCode(nullptr);
    std::string text = name ? name : "unnamed";
    if (authority && code) text += words(" (", authority, ":", code, ")");
    return text;
}

OGRSpatialReference parsed(const std::string& wkt) {
    OGRSpatialReference crs;
    crs.importFromWkt(wkt.c_str());
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return crs;
}

OGRSpatialReference demoted(const OGRSpatialReference& crs) {
    OGRSpatialReference flat(crs);
    if (flat.IsCompound()) flat.StripVertical();
    flat.DemoteTo2D(nullptr);
    flat.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return flat;
}

// The command that mends a raster in degrees, with the UTM zone of its centre.
std::string warp_advice(const Vec2& degrees) {
    const bool on_earth = std::abs(degrees.x()) <= 180 && std::abs(degrees.y()) <= 84;
    const int zone = on_earth ? std::min(60, static_cast<int>(std::floor((degrees.x() + 180) / 6)) + 1) : 0;
    const std::string code = on_earth ? words("EPSG:", (degrees.y() < 0 ? 32700 : 32600) + zone) : "EPSG:code";
    return words("reproject it to a projected CRS in metres, for example gdalwarp -r bilinear -t_srs ", code,
                 " in.tif out.tif");
}

// Ratio of ground to map distance minus one, the worse of east and north, over 1 km at the centre; none where it cannot be told.
std::optional<double> scale_error(const OGRSpatialReference& projected, const Vec2& centre) {
    const std::unique_ptr<OGRSpatialReference> geographic(projected.CloneGeogCS());
    if (!geographic) return std::nullopt;
    geographic->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> to_degrees(
        OGRCreateCoordinateTransformation(&projected, geographic.get()));
    if (!to_degrees) return std::nullopt;

    constexpr double kSpan = 1000.0;  // [m]
    double x[] = {centre.x(), centre.x() + kSpan, centre.x()};
    double y[] = {centre.y(), centre.y(), centre.y() + kSpan};
    int good[3];
    if (!to_degrees->Transform(3, x, y, nullptr, good) || !good[0] || !good[1] || !good[2]) return std::nullopt;

    const char* unit_name = nullptr;
    const double unit = geographic->GetAngularUnits(&unit_name) * 180 / std::numbers::pi;  // [degrees]; grads exist
    const double inverse_flattening = geographic->GetInvFlattening();
    geod_geodesic ellipsoid;
    geod_init(&ellipsoid, geographic->GetSemiMajor(), inverse_flattening > 0 ? 1 / inverse_flattening : 0);
    double worst = 0;
    for (const int i : {1, 2}) {
        double ground = 0;
        geod_inverse(&ellipsoid, y[0] * unit, x[0] * unit, y[i] * unit, x[i] * unit, &ground, nullptr, nullptr);
        const double error = ground / kSpan - 1;
        if (!std::isfinite(error)) return std::nullopt;
        if (std::abs(error) > std::abs(worst)) worst = error;
    }
    return worst;
}

// GDAL gives coordinates in the directions of the axes: where these are west and south, east is not to the right.
void check_directions(const OGRSpatialReference& flat, const std::string& name, const std::string& place) {
    int souths = 0;
    bool west = false;
    for (const int axis : {0, 1}) {
        OGRAxisOrientation towards = OAO_Other;
        if (!flat.GetAxis(nullptr, axis, &towards)) return;
        west = west || towards == OAO_West;
        souths += towards == OAO_South;  // of a polar map both are
    }
    if (!west && souths != 1) return;
    throw InputError(
        words(place, " has the CRS '", name,
              "', whose axes point to the west or south, but eastings must grow to the east and northings "
              "to the north; reproject it with gdalwarp -r bilinear -t_srs to a CRS that has such, UTM for "
              "example."));
}

void check_heights_up(const OGRSpatialReference& crs, const std::string& place) {
    OGRAxisOrientation towards = OAO_Up;
    if (crs.GetAxesCount() != 3 || !crs.GetAxis(nullptr, 2, &towards) || towards != OAO_Down) return;
    throw InputError(words(place, " has depths, positive downwards, by its CRS '", crs_name(crs),
                           "', but heights must grow upwards; turn them with gdal_calc.py -A in.tif --calc=-A "
                           "--outfile=out.tif and assign a CRS of heights."));
}

void check_vertical_unit(const OGRSpatialReference& crs, const std::string& place) {
    const bool in_one = crs.GetAxesCount() == 3 && !crs.IsCompound();  // a projected CRS with an axis of heights
    if (!crs.IsCompound() && !crs.IsVertical() && !in_one) return;
    const char* unit = nullptr;
    double metres = 1.0;
    if (in_one)
        crs.GetAxis(nullptr, 2, nullptr, &metres);
    else
        metres = crs.GetTargetLinearUnits("VERT_CS", &unit);
    if (std::abs(metres - 1) < 1e-9) return;
    throw InputError(words(place, " has heights in ", unit ? unit : "a unit other than metres", " (", metres,
                           " m) by its CRS '", crs_name(crs),
                           "', but heights must be in metres; convert them, for example gdal_calc.py -A in.tif "
                           "--calc=A*",
                           metres, " --outfile=out.tif, and assign a CRS whose heights are in metres."));
}

}  // namespace

HorizontalCrs horizontal_part(const OGRSpatialReference* crs) {
    if (!crs || crs->IsEmpty()) return {};
    // GeoPackage has codes for "no CRS"; GDAL shows them under these names
    const std::string name = crs->GetName() ? crs->GetName() : "";
    if (name.rfind("Undefined ", 0) == 0 || name.rfind("undefined ", 0) == 0) return {};
    const OGRSpatialReference flat = demoted(*crs);
    char* text = nullptr;
    const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
    flat.exportToWkt(&text, options);
    HorizontalCrs result{text ? text : "", crs_name(flat)};
    CPLFree(text);
    return result;
}

HorizontalCrs named_crs(const std::string& text, const std::string& place) {
    const GdalScope scope;
    OGRSpatialReference crs;
    static constexpr const char* kNoFiles[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
    const bool known = crs.SetFromUserInput(text.c_str(), kNoFiles) == OGRERR_NONE;
    const HorizontalCrs horizontal = known ? horizontal_part(&crs) : HorizontalCrs{};
    if (horizontal.wkt.empty())
        throw InputError(words(place, " names the CRS '", text, "', which PROJ does not know; write it as EPSG:2154."));
    return horizontal;
}

bool same_map(const std::string& a, const std::string& b) {
    if (a == b) return true;
    const OGRSpatialReference first = parsed(a), second = parsed(b);
    const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                   "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
    return first.IsSame(&second, options);
}

bool in_degrees(const std::string& wkt) {
    return parsed(wkt).IsGeographic();
}

HorizontalCrs metric_crs_or_throw(const OGRSpatialReference* crs, const Vec2& centre, const std::string& place,
                                  std::vector<std::string>& warnings) {
    const HorizontalCrs known = horizontal_part(crs);
    if (known.wkt.empty()) {
        warnings.push_back(words(
            place,
            " has no coordinate reference system: it is taken to be in metres, vector files are taken to "
            "be in the same system, and the outputs will have none; assign it with gdal_edit.py -a_srs EPSG:code."));
        return {};
    }
    const OGRSpatialReference flat = demoted(*crs);
    if (flat.IsGeographic() || flat.IsGeocentric() || flat.IsDerivedGeographic()) {
        throw InputError(words(place, " is in ", flat.IsGeocentric() ? "geocentric coordinates" : "degrees", " ('",
                               known.name, "'), but a map in metres is needed; ", warp_advice(centre), "."));
    }
    const char* unit = nullptr;
    const double metres = flat.GetLinearUnits(&unit);
    if (std::abs(metres - 1) > 1e-9) {
        throw InputError(words(
            place, " is in ", unit ? unit : "a unit other than metres", " (", metres, " m) by its CRS '", known.name,
            "', but the map must be in metres; reproject it with gdalwarp -r bilinear -t_srs to a CRS in metres and "
            "make sure that its heights are in metres too."));
    }
    check_vertical_unit(*crs, place);
    check_heights_up(*crs, place);
    if (!flat.IsProjected()) {
        warnings.push_back(words(place, " has a local CRS ('", known.name,
                                 "') that no other can be transformed to: vector files must be "
                                 "in the same one."));
        return known;
    }
    check_directions(flat, known.name, place);
    const std::optional<double> error = scale_error(flat, centre);
    if (!error) {
        warnings.push_back(
            words(place, " has the CRS '", known.name, "', whose scale at the site could not be checked."));
    } else if (std::abs(*error) > kScaleErrorRefused) {
        throw InputError(words(place, " has the CRS '", known.name, "', in which a metre of the map is ",
                               fixed(1 + *error, 3), " m on the ground at this site (allowed: within ",
                               100 * kScaleErrorRefused,
                               " %); reproject it with gdalwarp -r bilinear -t_srs to the national grid or to UTM."));
    } else if (std::abs(*error) > kScaleErrorWarned) {
        warnings.push_back(words(place, " has the CRS '", known.name,
                                 "', in which distances at this site are wrong by ", fixed(100 * std::abs(*error), 2),
                                 " %; the national grid or UTM would be better."));
    }
    return known;
}

}  // namespace scree::gis
