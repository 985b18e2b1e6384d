// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/vector_reader.hpp"

#include "gis/crs.hpp"
#include "gis/crs_transform.hpp"
#include "gis/dataset.hpp"
#include "gis/utf8.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace scree::gis {

namespace {

constexpr double kCurveStep = 1.0;     // angle of the chords that stand for arcs [degrees]: 0.04 mm per metre of radius
constexpr double kPoorAccuracy = 5.0;  // accuracy of a transformation that deserves a warning [m]

std::string kind_name(GeometryKind kind) {
    switch (kind) {
        case GeometryKind::Point:
            return "points";
        case GeometryKind::LineString:
            return "lines";
        case GeometryKind::Polygon:
            return "polygons";
        case GeometryKind::None:
            break;
    }
    return "no geometries";
}

OGRLayer& chosen_layer(GDALDataset& dataset, const VectorSource& source) {
    std::string names;
    std::vector<OGRLayer*> candidates;
    for (int i = 0; i < dataset.GetLayerCount(); ++i) {
        OGRLayer* layer = dataset.GetLayer(i);
        // tables without geometries, such as the styles that QGIS stores, are no candidates
        if (!layer || (layer->GetGeomType() == wkbNone && !source.geometry_optional)) continue;
        if (layer->GetName() == source.layer) return *layer;
        candidates.push_back(layer);
        names += words(candidates.size() > 1 ? ", '" : "'", layer->GetName(), "'");
    }
    const std::string place = words("The file of the ", source.purpose, " '", source.file, "'");
    if (candidates.empty()) throw InputError(words(place, " has no layer with geometries; name another file."));
    if (!source.layer.empty())
        throw InputError(words(place, " has no layer '", source.layer, "'; it has ", names, "."));
    if (candidates.size() > 1)
        throw InputError(words(place, " has several layers, ", names,
                               "; name the one to use with the key layer beside that of the file (start_layer, "
                               "guide_layer, line_layer, breaklines_layer where the file has such a prefix, too)."));
    return *candidates.front();
}

// Reads one layer; keeps what the messages need at hand.
class LayerReader {
public:
    LayerReader(const VectorSource& source, const LocalFrame& frame, const Box2& extent)
        : source_(source), frame_(frame), extent_(extent) {}

    VectorData read() {
        const DatasetPtr dataset = open_dataset(source_.file, DatasetKind::Vector, source_.purpose, scope_);
        OGRLayer& layer = chosen_layer(*dataset, source_);
        data_.layer.name = layer.GetName();
        data_.report.file = source_.file;
        data_.report.layer = layer.GetName();
        data_.report.driver = dataset->GetDriverName();
        place_ = words("The layer '", layer.GetName(), "' of the ", source_.purpose, " '", source_.file, "'");
        prepare_transform(layer);
        read_fields(*layer.GetLayerDefn());
        read_features(layer);
        check_extent();
        report_operation();
        return std::move(data_);
    }

private:
    void warn(const std::string& text) { data_.report.warnings.push_back(words(place_, " ", text)); }
    [[noreturn]] void refuse(const std::string& text) const { throw InputError(words(place_, " ", text)); }
    [[noreturn]] void refuse(std::int64_t id, const std::string& text) const {
        refuse(words("has feature ", id, ", ", text));
    }

    void prepare_transform(OGRLayer& layer) {
        if (layer.GetGeomType() == wkbNone) return;
        const HorizontalCrs crs = horizontal_part(layer.GetSpatialRef());
        data_.report.crs_name = crs.name;
        degrees_ = !crs.wkt.empty() && in_degrees(crs.wkt);
        if (crs.wkt.empty()) {
            warn(
                "has no coordinate reference system: it is taken to be in the terrain's; assign the right one in "
                "QGIS.");
        } else if (frame_.crs.empty()) {
            if (degrees_)
                refuse(words("is in degrees ('", crs.name,
                             "') but the terrain has no CRS to transform it to; assign one to the terrain."));
            warn(words("is in '", crs.name, "' but the terrain has no CRS: both are taken to be the same."));
        } else if (!same_map(crs.wkt, frame_.crs)) {
            transform_.emplace(crs.wkt, frame_.crs, words(place_, ", in '", crs.name, "',"));
        }
    }

    void read_fields(OGRFeatureDefn& definition) {
        for (int f = 0; f < definition.GetFieldCount(); ++f) {
            const OGRFieldDefn& field = *definition.GetFieldDefn(f);
            const OGRFieldType type = field.GetType();
            data_.layer.fields.push_back({field.GetNameRef(),
                                          type == OFTInteger || type == OFTInteger64 ? FieldType::Integer
                                          : type == OFTReal                          ? FieldType::Real
                                                                                     : FieldType::Text,
                                          field.GetAlternativeNameRef()});
        }
    }

    void read_features(OGRLayer& layer) {
        scope_.clear();
        std::size_t without_geometry = 0;
        std::int64_t first_without = 0;
        layer.ResetReading();
        while (const OGRFeatureUniquePtr feature{layer.GetNextFeature()}) {
            const OGRGeometry* geometry = feature->GetGeometryRef();
            if (geometry && !geometry->IsEmpty()) {
                read_feature(*feature, *geometry);
            } else if (source_.geometry_optional) {
                add_feature(*feature, {});
            } else if (++without_geometry == 1) {
                first_without = feature->GetFID();
            }
        }
        if (!scope_.reason().empty())
            refuse(words("cannot be read to its end", scope_.reason(), "; the file is damaged, copy it again."));
        if (data_.layer.features.empty() && !source_.geometry_optional) {
            refuse(without_geometry > 0 ? words("has ", counted(without_geometry, "feature"),
                                                " but none with a geometry; draw at least one.")
                                        : std::string("is empty; draw at least one feature."));
        }
        if (without_geometry > 0)
            warn(words("has ", counted(without_geometry, "feature"), " without a geometry (first: ", first_without,
                       "), left out."));
    }

    void read_feature(const OGRFeature& source, const OGRGeometry& original) {
        id_ = source.GetFID();
        std::unique_ptr<OGRGeometry> linear;
        if (original.hasCurveGeometry()) linear.reset(original.getLinearGeometry(kCurveStep));
        const OGRGeometry& geometry = linear ? *linear : original;

        const GeometryKind kind = kind_of(geometry);
        if (std::find(source_.kinds.begin(), source_.kinds.end(), kind) == source_.kinds.end()) {
            std::string wanted;
            for (const GeometryKind k : source_.kinds) wanted += words(wanted.empty() ? "" : " or ", kind_name(k));
            refuse(id_,
                   words("a ", OGRGeometryTypeToName(original.getGeometryType()), ", where ", wanted, " are needed."));
        }
        if (data_.layer.kind == GeometryKind::None) data_.layer.kind = kind;
        if (data_.layer.kind != kind) {
            refuse(id_,
                   words("a ", OGRGeometryTypeToName(original.getGeometryType()), ", while the features before are ",
                         kind_name(data_.layer.kind), "; put each kind into a layer of its own."));
        }
        if (kind == GeometryKind::Polygon) check_valid(geometry);

        box_ = {};
        Geometry local_geometry = converted(geometry, kind);
        boxes_.emplace_back(id_, box_);
        add_feature(source, std::move(local_geometry));
    }

    void add_feature(const OGRFeature& source, Geometry geometry) {
        Feature feature;
        feature.id = source.GetFID();
        feature.geometry = std::move(geometry);
        for (int f = 0; f < static_cast<int>(data_.layer.fields.size()); ++f)
            feature.values.push_back(value_of(source, f));
        data_.layer.features.push_back(std::move(feature));
    }

    static GeometryKind kind_of(const OGRGeometry& geometry) {
        switch (wkbFlatten(geometry.getGeometryType())) {
            case wkbPoint:
            case wkbMultiPoint:
                return GeometryKind::Point;
            case wkbLineString:
            case wkbMultiLineString:
                return GeometryKind::LineString;
            case wkbPolygon:
            case wkbMultiPolygon:
                return GeometryKind::Polygon;
            default:
                return GeometryKind::None;
        }
    }

    FieldValue value_of(const OGRFeature& source, int f) {
        if (!source.IsFieldSetAndNotNull(f)) return {};
        switch (data_.layer.fields[static_cast<std::size_t>(f)].type) {
            case FieldType::Integer:
                return static_cast<std::int64_t>(source.GetFieldAsInteger64(f));
            case FieldType::Real:
                return source.GetFieldAsDouble(f);
            case FieldType::Text:
                break;
        }
        std::string text = source.GetFieldAsString(f);
        if (is_utf8(text)) return text;
        if (!latin1_)
            warn(
                "has text that is not in UTF-8: it is taken to be in ISO-8859-1; a Shapefile says its encoding in a "
                ".cpg file.");
        latin1_ = true;
        return utf8_from_latin1(text);
    }

    // GEOS says what is wrong and where; we do not guess what was meant.
    void check_valid(const OGRGeometry& geometry) const {
        const GdalScope inner;
        if (geometry.IsValid()) return;
        const std::string what = inner.messages().empty() ? "it crosses itself" : inner.messages().back();
        refuse(id_, words("whose polygon is not valid (", what,
                          "); mend it, for example in QGIS with Vector geometry > Fix geometries."));
    }

    Vec2 local(double x, double y) {
        Vec2 map{x, y};
        if (transform_) {
            const std::optional<Vec2> moved = (*transform_)(map);
            const bool strange = degrees_ && (std::abs(x) > 360 || std::abs(y) > 90);
            if (!moved || strange) {
                refuse(id_,
                       words("whose position (", x, ", ", y, ") has no place in the terrain's CRS",
                             strange
                                 ? "; these are no degrees although the file says '" + data_.report.crs_name +
                                       "' (GeoJSON always does): save it with its true CRS, best as a GeoPackage."
                                 : "; check the coordinates and the CRS '" + data_.report.crs_name + "' of the file."));
            }
            map = *moved;
        }
        if (!std::isfinite(map.x()) || !std::isfinite(map.y()))
            refuse(id_, "which has a coordinate that is not a finite number; mend it.");
        const Vec2 p{map.x() - frame_.easting, map.y() - frame_.northing};
        box_.add(p);
        source_box_.add(Vec2{x, y});
        return p;
    }

    Vec3 local_3d(const OGRPoint& p) {
        const Vec2 plan = local(p.getX(), p.getY());
        const double z = p.Is3D() ? p.getZ() - frame_.height : kNaN;
        return {plan.x(), plan.y(), z};
    }

    Ring ring_of(const OGRLinearRing& source, bool counter_clockwise) {
        Ring ring;
        for (int i = 0; i < source.getNumPoints(); ++i) {
            const Vec2 p = local(source.getX(i), source.getY(i));
            if (ring.empty() || p != ring.back()) ring.push_back(p);
        }
        while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
        double twice_area = 0;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vec2 a = ring[i] - ring[0], b = ring[(i + 1) % ring.size()] - ring[0];
            twice_area += cross(a, b);
        }
        if (ring.size() < 3 || twice_area == 0)
            refuse(id_, "whose polygon has a ring without area; mend or delete it.");
        if ((twice_area > 0) != counter_clockwise) std::reverse(ring.begin(), ring.end());
        return ring;
    }

    Polygon polygon_of(const OGRPolygon& source) {
        Polygon polygon{ring_of(*source.getExteriorRing(), true), {}};
        for (int i = 0; i < source.getNumInteriorRings(); ++i)
            polygon.holes.push_back(ring_of(*source.getInteriorRing(i), false));
        return polygon;
    }

    Polyline line_of(const OGRLineString& source) {
        Polyline line;
        OGRPoint p;
        for (int i = 0; i < source.getNumPoints(); ++i) {
            source.getPoint(i, &p);
            const Vec3 q = local_3d(p);
            if (line.points.empty() || q.head<2>() != line.points.back().head<2>()) line.points.push_back(q);
        }
        if (line.points.size() < 2) refuse(id_, "whose line has no length; mend or delete it.");
        return line;
    }

    Geometry converted(const OGRGeometry& geometry, GeometryKind kind) {
        const bool multi = OGR_GT_IsSubClassOf(geometry.getGeometryType(), wkbGeometryCollection);
        const auto each = [&](auto&& use) {
            if (!multi) return use(geometry);
            for (const OGRGeometry* part : *geometry.toGeometryCollection()) {
                if (!part->IsEmpty()) use(*part);
            }
        };
        if (kind == GeometryKind::Point) {
            Points points;
            each([&](const OGRGeometry& g) { points.push_back(local_3d(*g.toPoint())); });
            return points;
        }
        if (kind == GeometryKind::LineString) {
            Polylines lines;
            each([&](const OGRGeometry& g) { lines.push_back(line_of(*g.toLineString())); });
            return lines;
        }
        MultiPolygon polygons;
        each([&](const OGRGeometry& g) { polygons.push_back(polygon_of(*g.toPolygon())); });
        return polygons;
    }

    // Would the layer lie on the terrain if its x and y changed places?
    bool fits_when_swapped() {
        const Vec2 centre = 0.5 * (source_box_.min + source_box_.max);
        Vec2 map{centre.y(), centre.x()};
        if (transform_) {
            const std::optional<Vec2> moved = (*transform_)(map);
            if (!moved) return false;
            map = *moved;
        }
        const double margin = (extent_.max - extent_.min).norm();
        return extent_.grown(margin).contains({map.x() - frame_.easting, map.y() - frame_.northing});
    }

    void check_extent() {
        Box2 all;
        std::size_t outside = 0, across = 0;
        std::int64_t first_outside = 0, first_across = 0;
        for (const auto& [id, box] : boxes_) {
            all.add(box);
            if (!extent_.overlaps(box)) {
                if (++outside == 1) first_outside = id;
            } else if (!(extent_.contains(box.min) && extent_.contains(box.max))) {
                if (++across == 1) first_across = id;
            }
        }
        data_.report.extent = all;
        if (outside == boxes_.size() && !boxes_.empty()) {
            refuse(words(
                "lies wholly outside of the terrain: it spans ", extent_text(all, frame_),
                " in the terrain's CRS, the terrain ", extent_text(extent_, frame_),
                fits_when_swapped()
                    ? "; with x and y exchanged it would fit: write longitude or easting first."
                    : "; check its coordinates and its CRS" +
                          (data_.report.crs_name.empty() ? std::string() : " '" + data_.report.crs_name + "'") + "."));
        }
        if (source_.may_reach_beyond) return;
        if (outside > 0)
            warn(words("has ", counted(outside, "feature"), " outside of the terrain (first: ", first_outside, ")."));
        if (across > 0)
            warn(words("has ", counted(across, "feature"), " reaching beyond the terrain (first: ", first_across,
                       "): only the part on it counts."));
    }

    void report_operation() {
        if (!transform_ || boxes_.empty()) return;
        const CrsTransform::Operation operation = transform_->last_operation();
        data_.report.operation = operation.name;
        data_.report.accuracy = operation.accuracy;
        if (!(operation.accuracy <= kPoorAccuracy)) {
            warn(words("was transformed from '", data_.report.crs_name, "' by '", operation.name,
                       "' with an accuracy of ",
                       std::isnan(operation.accuracy) ? std::string("unknown size") : words(operation.accuracy, " m"),
                       "; reproject it with the national grid files if that matters."));
        }
    }

    const VectorSource& source_;
    const LocalFrame& frame_;
    const Box2& extent_;
    GdalScope scope_;
    VectorData data_;
    std::string place_;
    std::optional<CrsTransform> transform_;
    bool degrees_ = false;
    bool latin1_ = false;                               ///< told that its texts are taken to be
    std::int64_t id_ = 0;                               // of the feature at hand
    Box2 box_;                                          // of the feature at hand [m]
    Box2 source_box_;                                   // of all features, in the CRS of the file
    std::vector<std::pair<std::int64_t, Box2>> boxes_;  // per feature with a geometry its id and extent [m]
};

}  // namespace

std::vector<std::string> layer_names(const std::string& file, const std::string& purpose) {
    const GdalScope scope;
    const DatasetPtr dataset = open_dataset(file, DatasetKind::Vector, purpose, scope);
    std::vector<std::string> names;
    for (int i = 0; i < dataset->GetLayerCount(); ++i)
        if (OGRLayer* layer = dataset->GetLayer(i)) names.emplace_back(layer->GetName());
    return names;
}

std::string extent_text(const Box2& box, const LocalFrame& frame) {
    return words("easting ", fixed(box.min.x() + frame.easting, 1), " to ", fixed(box.max.x() + frame.easting, 1),
                 ", northing ", fixed(box.min.y() + frame.northing, 1), " to ", fixed(box.max.y() + frame.northing, 1));
}

VectorData read_vector(const VectorSource& source, const LocalFrame& frame, const Box2& extent) {
    return LayerReader(source, frame, extent).read();
}

}  // namespace scree::gis
