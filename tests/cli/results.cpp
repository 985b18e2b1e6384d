// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/results.hpp"

#include <cpl_json.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace scree::test {

namespace fs = std::filesystem;

namespace {

GDALDatasetUniquePtr open(const fs::path& file, unsigned flags) {
    GDALAllRegister();
    return GDALDatasetUniquePtr(GDALDataset::Open(file.c_str(), flags | GDAL_OF_READONLY));
}

std::vector<double> pixels_of(GDALDataset& raster) {
    const int columns = raster.GetRasterXSize(), rows = raster.GetRasterYSize();
    std::vector<double> values(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    GDALRasterBand* band = raster.GetRasterBand(1);
    if (band->RasterIO(GF_Read, 0, 0, columns, rows, values.data(), columns, rows, GDT_Float64, 0, 0, nullptr) !=
        CE_None)
        values.clear();
    int has_no_data = 0;
    const double no_data = band->GetNoDataValue(&has_no_data);
    for (double& value : values)
        if (has_no_data && value == no_data) value = kNaN;
    return values;
}

}  // namespace

std::vector<PointRow> read_points(const fs::path& file, const std::string& layer) {
    std::vector<PointRow> points;
    const auto data = open(file, GDAL_OF_VECTOR);
    OGRLayer* rows = data ? data->GetLayerByName(layer.c_str()) : nullptr;
    if (!rows) return points;
    for (const auto& feature : *rows) {
        PointRow point;
        const OGRGeometry* shape = feature->GetGeometryRef();
        if (wkbFlatten(shape->getGeometryType()) == wkbPoint)
            point.at = {shape->toPoint()->getX(), shape->toPoint()->getY(), shape->toPoint()->getZ()};
        for (int k = 0; k < feature->GetFieldCount(); ++k)
            point.values[feature->GetFieldDefnRef(k)->GetNameRef()] = feature->GetFieldAsString(k);
        points.push_back(std::move(point));
    }
    return points;
}

std::set<std::string> fields_of(const fs::path& file, const std::string& layer) {
    std::set<std::string> names;
    const auto data = open(file, GDAL_OF_VECTOR);
    OGRLayer* rows = data ? data->GetLayerByName(layer.c_str()) : nullptr;
    for (int k = 0; rows && k < rows->GetLayerDefn()->GetFieldCount(); ++k)
        names.insert(rows->GetLayerDefn()->GetFieldDefn(k)->GetNameRef());
    return names;
}

std::string crs_code_of(const fs::path& file, const std::string& layer) {
    const auto data = open(file, GDAL_OF_VECTOR);
    OGRLayer* rows = data ? data->GetLayerByName(layer.c_str()) : nullptr;
    const char* code = rows && rows->GetSpatialRef() ? rows->GetSpatialRef()->GetAuthorityCode(nullptr) : nullptr;
    return code ? code : "";
}

RasterFacts raster_facts(const fs::path& file) {
    RasterFacts facts;
    const auto raster = open(file, GDAL_OF_RASTER);
    if (!raster) return {.finite = false};
    for (const double value : pixels_of(*raster)) {
        if (std::isnan(value)) continue;
        facts.low = std::min(facts.low, value);
        facts.high = std::max(facts.high, value);
        facts.sum += value;
        facts.finite = facts.finite && std::isfinite(value);
    }
    return facts;
}

std::vector<double> raster_cells(const fs::path& file) {
    const auto raster = open(file, GDAL_OF_RASTER);
    return raster ? pixels_of(*raster) : std::vector<double>{};
}

double raster_at(const fs::path& file, double easting, double northing) {
    const auto raster = open(file, GDAL_OF_RASTER);
    std::array<double, 6> t{};
    if (!raster || raster->GetGeoTransform(t.data()) != CE_None) return kNaN;
    const int column = static_cast<int>(std::floor((easting - t[0]) / t[1])),
              row = static_cast<int>(std::floor((northing - t[3]) / t[5]));
    if (column < 0 || row < 0 || column >= raster->GetRasterXSize() || row >= raster->GetRasterYSize()) return kNaN;
    double value = kNaN;
    if (raster->GetRasterBand(1)->RasterIO(GF_Read, column, row, 1, 1, &value, 1, 1, GDT_Float64, 0, 0, nullptr) !=
        CE_None)
        return kNaN;
    return value;
}

bool is_json_object(const std::string& line, const std::vector<std::string>& members) {
    CPLJSONDocument document;
    if (line.empty() || line.front() != '{' || !document.LoadMemory(line)) return false;
    return std::ranges::all_of(members,
                               [&](const std::string& name) { return document.GetRoot().GetObj(name).IsValid(); });
}

std::map<std::string, std::string> contents_of(const fs::path& folder) {
    std::map<std::string, std::string> contents;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        std::ifstream in(entry.path(), std::ios::binary);
        contents[entry.path().lexically_relative(folder).generic_string()] = {std::istreambuf_iterator<char>(in), {}};
    }
    return contents;
}

std::string without_pixels(std::string text) {
    const std::string begin = ";base64,";
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1)) {
        const std::size_t from = at + begin.size();
        text.erase(from, text.find('"', from) - from);
    }
    return text;
}

std::vector<std::string> differing_files(const fs::path& a, const fs::path& b, const std::set<std::string>& except) {
    const auto left = contents_of(a), right = contents_of(b);
    std::set<std::string> names;
    for (const auto& [name, bytes] : left) names.insert(name);
    for (const auto& [name, bytes] : right) names.insert(name);
    std::vector<std::string> differing;
    for (const std::string& name : names) {
        if (except.contains(name)) continue;
        if (!left.contains(name) || !right.contains(name) || left.at(name) != right.at(name)) differing.push_back(name);
    }
    return differing;
}

}  // namespace scree::test
