// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/vector_writer.hpp"

#include "gis/database.hpp"
#include "gis/output_scope.hpp"
#include "gis/spatial_index.hpp"
#include "gis/xml.hpp"
#include "scree/base/error.hpp"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <set>

namespace scree::gis {

namespace {

// --- what may be written ---

void check_layer(const VectorLayer& layer) {
    const FeatureLayer& data = layer.data;
    require_table_name(data.name, "vector layer");
    if (layer.coordinates == Coordinates::XYZM && data.kind == GeometryKind::Point) {
        throw InputError("layer " + data.name +
                         ": points have no M; write their time as a field, or declare the layer XYZ");
    }
    std::set<std::string> seen;
    for (const Field& field : data.fields) {
        require_table_name(field.name, "field of layer " + data.name);
        if (field.name == "fid" || field.name == "geom") {
            throw InputError("layer " + data.name + ": a field cannot be called \"" + field.name +
                             "\", which every layer has already; choose another name");
        }
        if (!seen.insert(field.name).second) {
            throw InputError("layer " + data.name + ": the field \"" + field.name +
                             "\" is given twice; names must differ");
        }
    }
    for (const VectorStyle& style : layer.styles) {
        if (!style.colour_by.empty() && !seen.contains(style.colour_by)) {
            throw InputError("layer " + data.name + ": the style \"" + style.name + "\" colours by the field \"" +
                             style.colour_by + "\", which the layer does not have");
        }
    }
}

bool is_multipart(const VectorLayer& layer) {
    if (layer.multipart) return true;
    const auto parts = [](const Feature& feature) -> std::size_t {
        if (const auto* points = std::get_if<Points>(&feature.geometry)) return points->size();
        if (const auto* lines = std::get_if<Polylines>(&feature.geometry)) return lines->size();
        if (const auto* polygons = std::get_if<MultiPolygon>(&feature.geometry)) return polygons->size();
        return 1;
    };
    return std::ranges::any_of(layer.data.features, [&](const Feature& feature) { return parts(feature) > 1; });
}

OGRwkbGeometryType wkb_type(const VectorLayer& layer, bool multipart) {
    OGRwkbGeometryType type = wkbNone;
    switch (layer.data.kind) {
        case GeometryKind::None:
            return wkbNone;
        case GeometryKind::Point:
            type = multipart ? wkbMultiPoint : wkbPoint;
            break;
        case GeometryKind::LineString:
            type = multipart ? wkbMultiLineString : wkbLineString;
            break;
        case GeometryKind::Polygon:
            return multipart ? wkbMultiPolygon : wkbPolygon;  // rings are plane
    }
    if (layer.coordinates != Coordinates::XY) type = OGR_GT_SetZ(type);
    if (layer.coordinates == Coordinates::XYZM) type = OGR_GT_SetM(type);
    return type;
}

OGRFieldType ogr_type(FieldType type) {
    switch (type) {
        case FieldType::Integer:
            return OFTInteger64;
        case FieldType::Real:
            return OFTReal;
        case FieldType::Text:
            break;
    }
    return OFTString;
}

// --- one layer ---

/// Writes the features of one layer and gathers extent and ranges on the way.
class LayerWriter {
public:
    LayerWriter(OGRLayer& target, const LocalFrame& frame, const VectorLayer& layer, bool multipart)
        : target_(target), frame_(frame), layer_(layer), multipart_(multipart) {
        written_.styles = layer.styles.empty() ? house_styles(layer.data) : layer.styles;
        written_.multipart = multipart;
        written_.colour_ranges.resize(written_.styles.size());
        // fields by which a style colours: their values are watched
        for (const VectorStyle& style : written_.styles) {
            std::size_t at = 0;
            while (at < layer.data.fields.size() && layer.data.fields[at].name != style.colour_by) ++at;
            watched_.push_back(at);
        }
        row_ = std::make_unique<OGRFeature>(target.GetLayerDefn());
    }

    /// False where the row could not be stored.
    bool write(const Feature& feature) {
        ++written_.features;
        if (feature.values.size() != layer_.data.fields.size()) {
            refuse(std::to_string(feature.values.size()) + " values for " + std::to_string(layer_.data.fields.size()) +
                   " fields; give one value per field");
        }
        row_->SetFID(written_.features);
        for (std::size_t i = 0; i < feature.values.size(); ++i) set_value(static_cast<int>(i), feature.values[i]);
        for (std::size_t i = 0; i < watched_.size(); ++i) {
            if (watched_[i] < feature.values.size()) watch(written_.colour_ranges[i], feature.values[watched_[i]]);
        }
        box_ = Box2();
        set_geometry(feature.geometry);
        if (!box_.empty()) {
            index_.push_back(index_entry(written_.features, box_.min.x(), box_.max.x(), box_.min.y(), box_.max.y()));
            written_.extent.add(box_);
        }
        return target_.CreateFeature(row_.get()) == OGRERR_NONE;
    }

    WrittenLayer take() { return std::move(written_); }
    std::vector<IndexEntry> take_index() { return std::move(index_); }

private:
    OGRLayer& target_;
    const LocalFrame& frame_;
    const VectorLayer& layer_;
    bool multipart_;
    WrittenLayer written_;
    std::vector<std::size_t> watched_;  ///< per style the place of its field, or the number of fields [-]
    Box2 box_;                          ///< of the feature at hand, map frame [m]
    std::vector<IndexEntry> index_;     ///< of all features, 24 bytes each
    std::unique_ptr<OGRFeature> row_;   ///< used again for every feature

    [[noreturn]] void refuse(const std::string& why) const {
        throw InputError("layer " + layer_.data.name + ", feature " + std::to_string(written_.features) + ": " + why);
    }

    static void watch(ValueRange& range, const FieldValue& value) {
        if (const auto* integer = std::get_if<std::int64_t>(&value)) range.add(static_cast<double>(*integer));
        if (const auto* real = std::get_if<double>(&value); real && std::isfinite(*real)) range.add(*real);
    }

    void set_value(int at, const FieldValue& value) {
        const Field& field = layer_.data.fields[static_cast<std::size_t>(at)];
        const auto* integer = std::get_if<std::int64_t>(&value);
        const auto* real = std::get_if<double>(&value);
        const auto* text = std::get_if<std::string>(&value);
        if (std::holds_alternative<std::monostate>(value) || (real && std::isnan(*real))) {
            row_->SetFieldNull(at);
        } else if (integer && field.type == FieldType::Integer) {
            row_->SetField(at, static_cast<GIntBig>(*integer));
        } else if (integer && field.type == FieldType::Real) {
            row_->SetField(at, static_cast<double>(*integer));
        } else if (real && field.type == FieldType::Real) {
            row_->SetField(at, *real);
        } else if (text && field.type == FieldType::Text) {
            row_->SetField(at, text->c_str());
        } else {
            refuse("the value of the field \"" + field.name +
                   "\" is not of the field's type; give integers for integer " +
                   "fields, numbers for real ones, text for text");
        }
    }

    // --- geometry ---

    void set_geometry(const Geometry& geometry) {
        if (std::holds_alternative<std::monostate>(geometry)) {
            row_->SetGeometryDirectly(nullptr);
            return;
        }
        std::unique_ptr<OGRGeometry> made;
        const auto* points = std::get_if<Points>(&geometry);
        const auto* lines = std::get_if<Polylines>(&geometry);
        const auto* areas = std::get_if<MultiPolygon>(&geometry);
        if (points && layer_.data.kind == GeometryKind::Point) {
            if (!multipart_ && points->size() == 1) return set_point(points->front());
            made = collect<OGRMultiPoint>(*points, [this](const Vec3& p) { return make_point(p); });
        } else if (lines && layer_.data.kind == GeometryKind::LineString) {
            made = collect<OGRMultiLineString>(*lines, [this](const Polyline& line) { return make_line(line); });
        } else if (areas && layer_.data.kind == GeometryKind::Polygon) {
            made = collect<OGRMultiPolygon>(*areas, [this](const Polygon& area) { return make_polygon(area); });
        } else {
            refuse("the geometry is not of the layer's kind; a layer holds either points, lines or polygons");
        }
        row_->SetGeometryDirectly(made.release());
    }

    template <class Multi, class Part, class Make>
    std::unique_ptr<OGRGeometry> collect(const std::vector<Part>& parts, Make make) {
        if (parts.empty()) refuse("the geometry has no parts; leave it NULL instead");
        if (!multipart_) {
            if (parts.size() > 1) refuse("the geometry has several parts; declare the layer multipart");
            return make(parts.front());
        }
        auto multi = std::make_unique<Multi>();
        for (const Part& part : parts) multi->addGeometryDirectly(make(part).release());
        return multi;
    }

    /// To the map frame; refuses what has no place on a map.
    MapPoint place(const Vec3& local) {
        const MapPoint p = frame_.to_map(local);
        const bool finite = std::isfinite(p.easting) && std::isfinite(p.northing) &&
                            (layer_.coordinates == Coordinates::XY || std::isfinite(p.height));
        if (!finite) refuse("a vertex has a coordinate that is not a number; leave the geometry NULL instead");
        box_.add(Vec2(p.easting, p.northing));
        return p;
    }

    /// The fast path of layers with millions of points: the point of the row before is moved, nothing is allocated.
    void set_point(const Vec3& local) {
        const MapPoint p = place(local);
        OGRGeometry* current = row_->GetGeometryRef();
        if (!current) {
            row_->SetGeometryDirectly(make_point(local).release());
            return;
        }
        OGRPoint* point = current->toPoint();
        point->setX(p.easting);
        point->setY(p.northing);
        if (layer_.coordinates != Coordinates::XY) point->setZ(p.height);
    }

    std::unique_ptr<OGRGeometry> make_point(const Vec3& local) {
        const MapPoint p = place(local);
        auto point = layer_.coordinates == Coordinates::XY
                         ? std::make_unique<OGRPoint>(p.easting, p.northing)
                         : std::make_unique<OGRPoint>(p.easting, p.northing, p.height);
        if (layer_.coordinates == Coordinates::XYZM) point->setMeasured(TRUE);
        return point;
    }

    std::unique_ptr<OGRGeometry> make_line(const Polyline& line) {
        const bool measured = layer_.coordinates == Coordinates::XYZM;
        if (line.points.size() < 2) refuse("a line needs at least two points; leave the geometry NULL instead");
        if (measured && line.measure.size() != line.points.size()) {
            refuse(std::to_string(line.measure.size()) + " measures for " + std::to_string(line.points.size()) +
                   " points; give one per point, or write the layer without M");
        }
        auto out = std::make_unique<OGRLineString>();
        if (layer_.coordinates != Coordinates::XY) out->set3D(TRUE);
        if (measured) out->setMeasured(TRUE);
        out->setNumPoints(static_cast<int>(line.points.size()));
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            const MapPoint p = place(line.points[i]);
            const int at = static_cast<int>(i);
            switch (layer_.coordinates) {
                case Coordinates::XY:
                    out->setPoint(at, p.easting, p.northing);
                    break;
                case Coordinates::XYZ:
                    out->setPoint(at, p.easting, p.northing, p.height);
                    break;
                case Coordinates::XYZM:
                    out->setPoint(at, p.easting, p.northing, p.height, line.measure[i]);
                    break;
            }
        }
        return out;
    }

    std::unique_ptr<OGRGeometry> make_polygon(const Polygon& area) {
        auto polygon = std::make_unique<OGRPolygon>();
        polygon->addRingDirectly(make_ring(area.outer).release());
        for (const Ring& hole : area.holes) polygon->addRingDirectly(make_ring(hole).release());
        return polygon;
    }

    std::unique_ptr<OGRLinearRing> make_ring(const Ring& ring) {
        if (ring.size() < 3) refuse("a ring of a polygon needs at least three points");
        auto out = std::make_unique<OGRLinearRing>();
        out->setNumPoints(static_cast<int>(ring.size()) + 1);
        for (std::size_t i = 0; i <= ring.size(); ++i) {
            const Vec2& corner = ring[i % ring.size()];
            const Vec2 p(corner.x() + frame_.easting, corner.y() + frame_.northing);
            if (!p.allFinite()) refuse("a ring has a coordinate that is not a number; leave the geometry NULL instead");
            box_.add(p);
            out->setPoint(static_cast<int>(i), p.x(), p.y());
        }
        return out;
    }
};

OGRLayer* create_layer(GDALDataset& file, const VectorLayer& layer, OGRSpatialReference& srs, bool multipart) {
    CPLStringList options;
    options.SetNameValue("IDENTIFIER", layer_title(layer, layer.data.name).c_str());
    options.SetNameValue("DESCRIPTION", layer.description.c_str());
    options.SetNameValue("SPATIAL_INDEX", "NO");  // ours is packed in one go, see spatial_index
    const OGRwkbGeometryType type = wkb_type(layer, multipart);
    OGRLayer* target =
        file.CreateLayer(layer.data.name.c_str(), type == wkbNone ? nullptr : &srs, type, options.List());
    if (!target) return nullptr;
    for (const Field& field : layer.data.fields) {
        OGRFieldDefn definition(field.name.c_str(), ogr_type(field.type));
        if (target->CreateField(&definition) != OGRERR_NONE) return nullptr;
    }
    return target;
}

WrittenLayer write_layer(GDALDataset& file, const LocalFrame& frame, OGRSpatialReference& srs, const VectorLayer& layer,
                         const OutputScope& scope, std::vector<IndexEntry>& index) {
    const std::string where = std::string(file.GetDescription()) + ", layer " + layer.data.name;
    const bool multipart = is_multipart(layer);
    OGRLayer* target = create_layer(file, layer, srs, multipart);
    if (!target) scope.fail(where, "the layer could not be created");
    LayerWriter writer(*target, frame, layer, multipart);
    const std::string lost = "a feature could not be stored; check that the disc has room";
    if (layer.next) {
        Feature feature;
        while (layer.next(feature)) {
            if (!writer.write(feature)) scope.fail(where, lost);
        }
    } else {
        for (const Feature& feature : layer.data.features) {
            if (!writer.write(feature)) scope.fail(where, lost);
        }
    }
    index = writer.take_index();
    return writer.take();
}

}  // namespace

void require_table_name(const std::string& name, const std::string& what) {
    const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
    const bool spelled = !name.empty() && name.size() <= 60 && name.front() >= 'a' && name.front() <= 'z' &&
                         std::ranges::all_of(name, allowed);
    const bool reserved = name.starts_with("gpkg_") || name.starts_with("sqlite_") || name.starts_with("rtree_") ||
                          name == "layer_styles" || name == "run";
    if (!spelled || reserved) {
        throw InputError(
            what + ": the name \"" + name +
            "\" cannot be used; allowed are a-z, 0-9 and _, a letter first, at most 60 characters, not gpkg_*, " +
            "sqlite_*, rtree_*, layer_styles or run");
    }
}

std::vector<WrittenLayer> write_vector_layers(const std::filesystem::path& geopackage, const LocalFrame& frame,
                                              std::span<const VectorLayer> layers) {
    for (const VectorLayer& layer : layers) check_layer(layer);
    const OutputScope scope;
    const SpatialReference srs = geopackage_spatial_reference(frame);
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    if (!driver)
        throw ComputeError(geopackage.string() + ": GDAL has no driver GPKG here; check GDAL_SKIP, or install it");
    DatasetPtr file(driver->Create(geopackage.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (!file)
        scope.fail(geopackage.string(),
                   "the GeoPackage could not be created; check that its folder exists and is writable");

    // one transaction: with one per row, points take seven times as long
    std::vector<WrittenLayer> written;
    std::vector<std::vector<IndexEntry>> indexes(layers.size());
    const std::string lost = "the layers could not be stored; check that the disc has room";
    if (file->StartTransaction() != OGRERR_NONE) scope.fail(geopackage.string(), lost);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        written.push_back(write_layer(*file, frame, *srs, layers[i], scope, indexes[i]));
    }
    if (file->CommitTransaction() != OGRERR_NONE) scope.fail(geopackage.string(), lost);
    file.reset();  // writes the extents; errors come as messages only
    scope.check(geopackage.string(), lost);

    Database database(geopackage);
    database.run("BEGIN");
    for (std::size_t i = 0; i < layers.size(); ++i) {
        if (layers[i].data.kind == GeometryKind::None) continue;
        write_spatial_index(database, layers[i].data.name, std::move(indexes[i]));
    }
    database.run("COMMIT");
    return written;
}

}  // namespace scree::gis
