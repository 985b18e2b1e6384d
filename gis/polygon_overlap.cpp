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

void add_parts(const OGRGeometry& geometry, Overlap& overlap) {
    if (OGR_GT_IsSubClassOf(geometry.getGeometryType(), wkbGeometryCollection)) {
        for (const OGRGeometry* part : *geometry.toGeometryCollection()) add_parts(*part, overlap);
    } else if (wkbFlatten(geometry.getGeometryType()) == wkbPolygon) {
        const OGRPolygon& polygon = *geometry.toPolygon();
        overlap.area += polygon.get_Area();
        for (const OGRLinearRing* ring : polygon) overlap.perimeter += ring->get_Length();
    }
}

}  // namespace

Overlap polygon_overlap(const MultiPolygon& a, const MultiPolygon& b) {
    const GdalScope scope;
    const OGRMultiPolygon first = to_ogr(a), second = to_ogr(b);
    const std::unique_ptr<OGRGeometry> common(first.Intersection(&second));
    if (!common) throw ComputeError(words("The overlap of two polygons could not be computed", scope.reason(), "."));
    Overlap overlap;
    add_parts(*common, overlap);
    return overlap;
}

}  // namespace scree::gis
