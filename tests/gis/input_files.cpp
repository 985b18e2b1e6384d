// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/input_files.hpp"

#include "scree/base/error.hpp"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <memory>
#include <stdexcept>

namespace scree::test {

namespace {

void require(bool condition, const char* what) {
    if (!condition) throw std::runtime_error(std::string("test file: ") + what);
}

struct Closer {
    void operator()(GDALDataset* d) const { GDALClose(d); }
};

}  // namespace

void write_raster(const std::string& file, const RasterSpec& spec) {
    GDALAllRegister();
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    std::unique_ptr<GDALDataset, Closer> data(memory->Create("", spec.columns, spec.rows,
                                                             spec.bands + (spec.alpha ? 1 : 0),
                                                             GDALGetDataTypeByName(spec.type.c_str()), nullptr));
    require(data != nullptr, "cannot create the raster");
    auto transform = spec.geotransform;
    data->SetGeoTransform(transform.data());
    if (!spec.crs.empty()) {
        OGRSpatialReference crs;
        require(crs.SetFromUserInput(spec.crs.c_str()) == OGRERR_NONE, "unknown CRS");
        data->SetSpatialRef(&crs);
    }
    const auto fill = [&](GDALRasterBand* band, const std::function<double(int, int)>& value) {
        std::vector<double> row(static_cast<std::size_t>(spec.columns));
        for (int r = 0; r < spec.rows; ++r) {
            for (int c = 0; c < spec.columns; ++c) row[static_cast<std::size_t>(c)] = value(c, r);
            require(band->RasterIO(GF_Write, 0, r, spec.columns, 1, row.data(), spec.columns, 1, GDT_Float64, 0, 0,
                                   nullptr) == CE_None,
                    "cannot write pixels");
        }
    };
    for (int b = 1; b <= spec.bands; ++b) {
        GDALRasterBand* band = data->GetRasterBand(b);
        if (spec.nodata) band->SetNoDataValue(*spec.nodata);
        if (!spec.unit.empty()) band->SetUnitType(spec.unit.c_str());
        if (spec.scale != 1) band->SetScale(spec.scale);
        if (spec.offset != 0) band->SetOffset(spec.offset);
        fill(band, spec.value);
    }
    if (spec.alpha) {
        GDALRasterBand* band = data->GetRasterBand(spec.bands + 1);
        band->SetColorInterpretation(GCI_AlphaBand);
        fill(band, spec.alpha);
    }
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(spec.driver.c_str());
    const std::unique_ptr<GDALDataset, Closer> out(
        driver->CreateCopy(file.c_str(), data.get(), FALSE, nullptr, nullptr, nullptr));
    require(out != nullptr, "cannot write the raster");
}

void write_vector(const std::string& file, const VectorSpec& spec, bool append) {
    GDALAllRegister();
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(spec.driver.c_str());
    std::unique_ptr<GDALDataset, Closer> data(append ? GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE)
                                                     : driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    require(data != nullptr, "cannot create the vector file");
    OGRSpatialReference crs;
    if (!spec.crs.empty()) {
        require(crs.SetFromUserInput(spec.crs.c_str()) == OGRERR_NONE, "unknown CRS");
        crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    }
    OGRLayer* layer = data->CreateLayer(spec.layer.c_str(), spec.crs.empty() ? nullptr : &crs, wkbUnknown, nullptr);
    require(layer != nullptr, "cannot create the layer");
    OGRFieldDefn text(spec.text_field.c_str(), OFTString), number(spec.number_field.c_str(), OFTReal);
    require(layer->CreateField(&text) == OGRERR_NONE && layer->CreateField(&number) == OGRERR_NONE,
            "cannot create fields");
    for (const VectorSpec::Row& row : spec.rows) {
        OGRFeature feature(layer->GetLayerDefn());
        if (!row.wkt.empty()) {
            OGRGeometry* geometry = nullptr;
            require(OGRGeometryFactory::createFromWkt(row.wkt.c_str(), nullptr, &geometry) == OGRERR_NONE, "bad WKT");
            feature.SetGeometryDirectly(geometry);
        }
        feature.SetField(0, row.text.c_str());
        if (row.number) feature.SetField(1, *row.number);
        require(layer->CreateFeature(&feature) == OGRERR_NONE, "cannot write a feature");
    }
}

std::string input_error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace scree::test
