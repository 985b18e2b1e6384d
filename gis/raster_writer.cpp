// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/raster_writer.hpp"

#include "gis/output_scope.hpp"
#include "gis/vector_writer.hpp"
#include "gis/xml.hpp"
#include "scree/base/error.hpp"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <cmath>
#include <fstream>

namespace scree::gis {

namespace {

/// No value in a GeoPackage, whose tables cannot hold NaN: what every GIS knows, and tagged. Below all that Scree computes.
constexpr float kCoverageNoData = -9999.0F;

constexpr int kTile = 512;  ///< edge of the tiles of a GeoTIFF [pixel]

void check_raster(const RasterLayer& layer) {
    require_table_name(layer.name, "raster layer");
    const GridShape& shape = layer.values.shape;
    if (shape.columns < 1 || shape.rows < 1 || layer.values.values.size() != shape.size() || !(shape.cell > 0)) {
        throw InputError("raster layer " + layer.name + ": " + std::to_string(layer.values.values.size()) +
                         " values for " + std::to_string(shape.columns) + " x " + std::to_string(shape.rows) +
                         " cells of " + number_text(shape.cell) +
                         " m; a raster needs at least one cell and one value per cell");
    }
}

/// Values with the north first, as they lie on disc.
struct Pixels {
    int columns = 0;              ///< [-]
    int rows = 0;                 ///< [-]
    std::vector<float> values{};  ///< row by row from the north-west [unit of the layer]
};

Pixels north_first(const Grid<float>& grid, float no_data) {
    Pixels out{grid.shape.columns, grid.shape.rows};
    out.values.reserve(grid.values.size());
    for (int row = grid.shape.rows - 1; row >= 0; --row) {
        for (int column = 0; column < grid.shape.columns; ++column) {
            const float value = grid.at(column, row);
            out.values.push_back(std::isnan(value) ? no_data : value);
        }
    }
    return out;
}

/// Half the resolution; each pixel holds the largest or the mean of the two by two that have a value.
Pixels halved(const Pixels& fine, bool mean) {
    Pixels out{(fine.columns + 1) / 2, (fine.rows + 1) / 2};
    out.values.reserve(static_cast<std::size_t>(out.columns) * static_cast<std::size_t>(out.rows));
    for (int row = 0; row < out.rows; ++row) {
        for (int column = 0; column < out.columns; ++column) {
            double sum = 0;
            double largest = -kInfinity;
            int count = 0;
            for (int y = 2 * row; y < std::min(2 * row + 2, fine.rows); ++y) {
                for (int x = 2 * column; x < std::min(2 * column + 2, fine.columns); ++x) {
                    const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(fine.columns);
                    const auto value = static_cast<double>(fine.values[at + static_cast<std::size_t>(x)]);
                    if (std::isnan(value)) continue;
                    sum += value;
                    largest = std::max(largest, value);
                    ++count;
                }
            }
            const double value = count == 0 ? kNaN : mean ? sum / count : largest;
            out.values.push_back(static_cast<float>(value));
        }
    }
    return out;
}

bool write_pixels(GDALRasterBand& band, const Pixels& pixels) {
    // GDAL wants a pointer to non-const also where it only reads
    auto* data = const_cast<float*>(pixels.values.data());
    return band.RasterIO(GF_Write, 0, 0, pixels.columns, pixels.rows, data, pixels.columns, pixels.rows, GDT_Float32, 0,
                         0, nullptr) == CE_None;
}

/// The raster in GDAL's memory, placed on the map.
DatasetPtr in_memory(const LocalFrame& frame, OGRSpatialReference* srs, const RasterLayer& layer, const Pixels& pixels,
                     float no_data) {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("MEM");
    DatasetPtr out(!driver ? nullptr : driver->Create("", pixels.columns, pixels.rows, 1, GDT_Float32, nullptr));
    if (!out) return nullptr;
    const GridShape& shape = layer.values.shape;
    // the geotransform names the outer corner of the north-western cell; ours is the south-western one
    std::array<double, 6> transform = {frame.easting + shape.origin.x(),
                                       shape.cell,
                                       0,
                                       frame.northing + shape.origin.y() + shape.rows * shape.cell,
                                       0,
                                       -shape.cell};
    out->SetGeoTransform(transform.data());
    if (srs) out->SetSpatialRef(srs);
    GDALRasterBand& band = *out->GetRasterBand(1);
    band.SetNoDataValue(static_cast<double>(no_data));
    band.SetDescription(layer.name.c_str());
    band.SetMetadataItem("TITLE", layer_title(layer, layer.name).c_str());
    if (!layer.unit.empty() && layer.unit != "-") band.SetUnitType(layer.unit.c_str());
    if (!layer.quantity_definition.empty()) band.SetMetadataItem("QUANTITY", layer.quantity_definition.c_str());
    if (!write_pixels(band, pixels)) return nullptr;
    return out;
}

/// Gives the raster overviews of our own making; the COG driver takes them over.
bool add_overviews(GDALDataset& raster, Pixels pixels, bool mean) {
    std::vector<int> factors;
    for (int factor = 2; std::max(pixels.columns, pixels.rows) > kTile * factor / 2; factor *= 2)
        factors.push_back(factor);
    if (factors.empty()) return true;
    const int count = static_cast<int>(factors.size());
    if (raster.BuildOverviews("NONE", count, factors.data(), 0, nullptr, nullptr, nullptr) != CE_None) return false;
    for (int i = 0; i < count; ++i) {
        pixels = halved(pixels, mean);
        GDALRasterBand* overview = raster.GetRasterBand(1)->GetOverview(i);
        if (!overview || overview->GetXSize() != pixels.columns || overview->GetYSize() != pixels.rows) return false;
        if (!write_pixels(*overview, pixels)) return false;
    }
    return true;
}

void copy_to(const char* format, const std::filesystem::path& file, GDALDataset& source, const CPLStringList& options,
             const OutputScope& scope) {
    const std::string lost = "the raster could not be stored; check that the folder is writable and the disc has room";
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format);
    if (!driver)
        throw ComputeError(file.string() + ": GDAL has no driver " + format + " here; check GDAL_SKIP, or install it");
    DatasetPtr copy(driver->CreateCopy(file.c_str(), &source, TRUE, options.List(), nullptr, nullptr));
    if (!copy) scope.fail(file.string(), lost);
    copy.reset();
    scope.check(file.string(), lost);
}

}  // namespace

WrittenRaster write_geotiff(const std::filesystem::path& tif, const LocalFrame& frame, const RasterLayer& layer) {
    check_raster(layer);
    const OutputScope scope;
    const SpatialReference srs = spatial_reference(frame);
    const auto no_data = std::numeric_limits<float>::quiet_NaN();
    Pixels pixels = north_first(layer.values, no_data);
    const DatasetPtr raster = in_memory(frame, srs.get(), layer, pixels, no_data);
    const bool mean = layer.theme == RasterTheme::Terrain || layer.theme == RasterTheme::Slope;
    if (!raster || !add_overviews(*raster, std::move(pixels), mean)) {
        scope.fail(tif.string(), "the raster could not be prepared in memory");
    }
    CPLStringList options;
    options.SetNameValue("COMPRESS", "DEFLATE");
    options.SetNameValue("PREDICTOR", "FLOATING_POINT");
    options.SetNameValue("OVERVIEW_PREDICTOR", "FLOATING_POINT");
    options.SetNameValue("BLOCKSIZE", std::to_string(kTile).c_str());
    options.SetNameValue("OVERVIEWS", "AUTO");
    options.SetNameValue("BIGTIFF", "IF_SAFER");
    copy_to("COG", tif, *raster, options, scope);

    std::filesystem::path qml = tif;
    qml.replace_extension(".qml");
    WrittenRaster written{raster_qgis_style(layer), layer.values.shape.bounds()};
    std::ofstream out(qml, std::ios::binary);
    out << qml_document(written.style);
    if (!out.flush())
        throw ComputeError(qml.string() + ": the style could not be stored; check that the disc has room");
    return written;
}

void append_coverage(const std::filesystem::path& geopackage, const LocalFrame& frame, const RasterLayer& layer) {
    check_raster(layer);
    if (std::ranges::find(layer.values.values, kCoverageNoData) != layer.values.values.end()) {
        throw InputError("raster layer " + layer.name +
                         ": the value -9999 stands for no value in a GeoPackage; give NaN for that");
    }
    const OutputScope scope;
    const SpatialReference srs = geopackage_spatial_reference(frame);
    const Pixels pixels = north_first(layer.values, kCoverageNoData);
    const DatasetPtr raster = in_memory(frame, srs.get(), layer, pixels, kCoverageNoData);
    if (!raster)
        scope.fail(geopackage.string() + ", raster " + layer.name, "the raster could not be prepared in memory");
    const std::string& title = layer_title(layer, layer.name);
    CPLStringList options;
    options.SetNameValue("APPEND_SUBDATASET", "YES");
    options.SetNameValue("RASTER_TABLE", layer.name.c_str());
    options.SetNameValue("RASTER_IDENTIFIER", title.c_str());
    options.SetNameValue("RASTER_DESCRIPTION", layer.quantity_definition.c_str());
    options.SetNameValue("TILE_FORMAT", "TIFF");
    options.SetNameValue("FIELD_NAME", title.c_str());
    options.SetNameValue("QUANTITY_DEFINITION",
                         (layer.quantity_definition.empty() ? title : layer.quantity_definition).c_str());
    if (!layer.unit.empty() && layer.unit != "-") options.SetNameValue("UOM", layer.unit.c_str());
    // a height belongs to the centre of its cell, a count or a maximum to the whole of it
    const bool centre = layer.theme == RasterTheme::Terrain || layer.theme == RasterTheme::Slope;
    options.SetNameValue("GRID_CELL_ENCODING", centre ? "grid-value-is-center" : "grid-value-is-area");
    copy_to("GPKG", geopackage, *raster, options, scope);
}

}  // namespace scree::gis
