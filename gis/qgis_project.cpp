// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a project of QGIS 3.22 that it needs; see gis/qml.cpp.
#include "gis/qgis_project.hpp"

#include "gis/output_scope.hpp"
#include "gis/qml.hpp"
#include "gis/xml.hpp"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

namespace scree::gis {

namespace {

/// One layer in the project's two lists: the tree (order, groups, switches) and the layers themselves.
struct ProjectLayer {
    std::string id{};
    std::string title{};
    std::string group{};
    std::string source{};
    std::string provider{};    ///< "ogr" or "gdal"
    std::string attributes{};  ///< of its element
    QgisStyle style{};
    Box2 extent{};  ///< map frame [m]
    bool visible = false;
    bool expanded = false;  ///< classes shown in the legend
};

std::string extent_xml(const Box2& box) {
    if (box.empty()) return {};
    return "<extent><xmin>" + number_text(box.min.x()) + "</xmin><ymin>" + number_text(box.min.y()) + "</ymin><xmax>" +
           number_text(box.max.x()) + "</xmax><ymax>" + number_text(box.max.y()) + "</ymax></extent>\n";
}

std::string srs_xml(const LocalFrame& frame) {
    const SpatialReference srs = spatial_reference(frame);
    if (!srs) return "<spatialrefsys nativeFormat=\"Wkt\"><wkt></wkt></spatialrefsys>";
    std::string out = "<spatialrefsys nativeFormat=\"Wkt\"><wkt>" + xml_text(frame.crs) + "</wkt>";
    const char* authority = srs->GetAuthorityName(nullptr);
    const char* code = srs->GetAuthorityCode(nullptr);
    if (authority && code) out += "<authid>" + xml_text(std::string(authority) + ":" + code) + "</authid>";
    return out + "<description>" + xml_text(srs->GetName() ? srs->GetName() : "") +
           "</description><geographicflag>false</geographicflag></spatialrefsys>";
}

std::string wkb_name(const VectorLayer& layer, bool multipart) {
    const std::string multi = multipart ? "Multi" : "";
    switch (layer.data.kind) {
        case GeometryKind::None:
            return "NoGeometry";
        case GeometryKind::Polygon:
            return multi + "Polygon";
        case GeometryKind::Point:
        case GeometryKind::LineString:
            break;
    }
    const std::string kind = layer.data.kind == GeometryKind::Point ? "Point" : "LineString";
    const std::string suffix = layer.coordinates == Coordinates::XY    ? ""
                               : layer.coordinates == Coordinates::XYZ ? "Z"
                                                                       : "ZM";
    return multi + kind + suffix;
}

std::string geometry_name(GeometryKind kind) {
    switch (kind) {
        case GeometryKind::Point:
            return "Point";
        case GeometryKind::LineString:
            return "Line";
        case GeometryKind::Polygon:
            return "Polygon";
        case GeometryKind::None:
            break;
    }
    return "No geometry";
}

ProjectLayer vector_entry(const VectorLayer& layer, const WrittenLayer& written) {
    ProjectLayer out;
    out.id = "vector_" + layer.data.name;
    out.title = layer_title(layer, layer.data.name);
    out.group = layer.group;
    out.source = "./results.gpkg|layername=" + layer.data.name;
    out.provider = "ogr";
    out.style = vector_qgis_style(layer, written.styles.front(), written.colour_ranges.front());
    out.attributes = " type=\"vector\" geometry=\"" + geometry_name(layer.data.kind) + "\" wkbType=\"" +
                     wkb_name(layer, written.multipart) + "\"" + out.style.attributes;
    out.extent = written.extent;
    out.visible = layer.visible;
    out.expanded = layer.visible && !written.styles.front().colour_by.empty();
    return out;
}

ProjectLayer raster_entry(const LocalFrame& frame, const RasterLayer& layer, const WrittenRaster& written) {
    ProjectLayer out;
    out.id = "raster_" + layer.name;
    out.title = layer_title(layer, layer.name);
    if (!layer.unit.empty() && layer.unit != "-") out.title += " [" + layer.unit + "]";
    out.group = layer.group;
    out.source = "./rasters/" + layer.name + ".tif";
    out.provider = "gdal";
    out.style = written.style;
    out.attributes = " type=\"raster\"";
    const Vec2 shift(frame.easting, frame.northing);
    out.extent.add(written.extent.min + shift);
    out.extent.add(written.extent.max + shift);
    out.visible = layer.visible;
    out.expanded = layer.visible && layer.theme != RasterTheme::Terrain;
    return out;
}

// --- the tree ---

const char* checked(bool on) {
    return on ? "Qt::Checked" : "Qt::Unchecked";
}

std::string tree_layer(const ProjectLayer& layer) {
    return "<layer-tree-layer id=\"" + layer.id + "\" name=\"" + xml_text(layer.title) + "\" source=\"" +
           xml_text(layer.source) + "\" providerKey=\"" + layer.provider + "\" checked=\"" + checked(layer.visible) +
           "\" expanded=\"" + (layer.expanded ? "1" : "0") + "\"/>\n";
}

std::string layer_tree(std::span<const ProjectLayer> layers) {
    std::string out = "<layer-tree-group>\n";
    std::vector<std::string> done;
    for (const ProjectLayer& layer : layers) {
        if (layer.group.empty()) {
            out += tree_layer(layer);
            continue;
        }
        if (std::ranges::find(done, layer.group) != done.end()) continue;
        done.push_back(layer.group);
        std::string members;
        bool any_visible = false;
        for (const ProjectLayer& member : layers) {
            if (member.group != layer.group) continue;
            members += tree_layer(member);
            any_visible = any_visible || member.visible;
        }
        // a group stays switched on: to see a layer of it takes one click, not two
        out += "<layer-tree-group name=\"" + xml_text(layer.group) + "\" checked=\"Qt::Checked\" expanded=\"" +
               (any_visible ? "1" : "0") + "\">\n" + members + "</layer-tree-group>\n";
    }
    return out + "</layer-tree-group>\n";
}

std::string map_layer(const ProjectLayer& layer, const std::string& srs) {
    return "<maplayer" + layer.attributes + " styleCategories=\"AllStyleCategories\">\n" + extent_xml(layer.extent) +
           "<id>" + layer.id + "</id>\n<datasource>" + xml_text(layer.source) + "</datasource>\n<layername>" +
           xml_text(layer.title) + "</layername>\n<srs>" + srs + "</srs>\n<provider" +
           (layer.provider == "ogr" ? " encoding=\"UTF-8\"" : "") + ">" + layer.provider + "</provider>\n" +
           layer.style.elements + "</maplayer>\n";
}

/// What the map shows first: all layers that are switched on, or else all, with a margin.
Box2 view_extent(std::span<const ProjectLayer> layers) {
    Box2 visible;
    Box2 all;
    for (const ProjectLayer& layer : layers) {
        if (layer.extent.empty()) continue;
        all.add(layer.extent);
        if (layer.visible) visible.add(layer.extent);
    }
    const Box2 box = visible.empty() ? all : visible;
    return box.empty() ? box : box.grown(0.03 * (box.max - box.min).maxCoeff());
}

}  // namespace

std::string qgis_project(const LocalFrame& frame, const std::string& title, std::span<const VectorLayer> vectors,
                         std::span<const WrittenLayer> written, std::span<const RasterLayer> rasters,
                         std::span<const WrittenRaster> written_rasters) {
    std::vector<ProjectLayer> layers;
    for (std::size_t i = 0; i < vectors.size(); ++i) layers.push_back(vector_entry(vectors[i], written[i]));
    for (std::size_t k = 0; k < rasters.size(); ++k)
        layers.push_back(raster_entry(frame, rasters[k], written_rasters[k]));

    const std::string srs = srs_xml(frame);
    std::string out =
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n<qgis version=\"3.22.0\" projectname=\"" +
        xml_text(title) + "\">\n<title>" + xml_text(title) + "</title>\n<projectCrs>" + srs + "</projectCrs>\n";
    out += layer_tree(layers);
    out += "<mapcanvas name=\"theMapCanvas\">\n<units>meters</units>\n" + extent_xml(view_extent(layers)) +
           "<rotation>0</rotation>\n<destinationsrs>" + srs + "</destinationsrs>\n</mapcanvas>\n<projectlayers>\n";
    for (const ProjectLayer& layer : layers) out += map_layer(layer, srs);
    out += "</projectlayers>\n<layerorder>\n";
    for (const ProjectLayer& layer : layers) out += "<layer id=\"" + layer.id + "\"/>\n";
    out +=
        "</layerorder>\n<properties>\n<Paths><Absolute type=\"bool\">false</Absolute></Paths>\n"
        "<SpatialRefSys><ProjectionsEnabled type=\"int\">" +
        std::string(frame.crs.empty() ? "0" : "1") + "</ProjectionsEnabled></SpatialRefSys>\n</properties>\n</qgis>\n";
    return out;
}

}  // namespace scree::gis
