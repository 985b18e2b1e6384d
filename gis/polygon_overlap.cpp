// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/polygon_overlap.hpp"

#include "gis/gdal_scope.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <ogr_geometry.h>

#include <memory>

namespace scree::gis {

namespace {

OGRMultiPolygon to_ogr(const MultiPolygon& polygons) {
    OGRMultiPolygon result;
    for (const Polygon& polygon : polygons) {
        OGRPolygon shape;
        const auto add = [&](const Ring& ring) {
            OGRLinearRing closed;
            for (const Vec2& p : ring) closed.addPoint(p.x(), p.y());
            closed.closeRings();
            shape.addRing(&closed);
        };
        add(polygon.outer);
        for (const Ring& hole : polygon.holes) add(hole);
        result.addGeometry(&shape);
    }
    return result;
}

double area_of(const OGRGeometry& geometry) {
    double area = 0.0;
    if (OGR_GT_IsSubClassOf(geometry.getGeometryType(), wkbGeometryCollection)) {
        for (const OGRGeometry* part : *geometry.toGeometryCollection()) area += area_of(*part);
    } else if (wkbFlatten(geometry.getGeometryType()) == wkbPolygon) {
        area = geometry.toPolygon()->get_Area();
    }
    return area;
}

}  // namespace

Overlap polygon_overlap(const MultiPolygon& a, const MultiPolygon& b, double width) {
    const GdalScope scope;
    const OGRMultiPolygon first = to_ogr(a), second = to_ogr(b);
    const std::unique_ptr<OGRGeometry> common(first.Intersection(&second));
    if (!common) throw ComputeError(words("The overlap of two polygons could not be computed", scope.reason(), "."));
    Overlap overlap{area_of(*common), false};
    if (!(overlap.area > 0.0)) return overlap;
    const std::unique_ptr<OGRGeometry> inside(common->Buffer(-0.5 * width));
    if (!inside) throw ComputeError(words("The overlap of two polygons could not be measured", scope.reason(), "."));
    overlap.is_wide = area_of(*inside) > 0.0;
    return overlap;
}

}  // namespace scree::gis
