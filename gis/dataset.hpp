// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/gdal_scope.hpp"

#include <memory>
#include <string>
#include <vector>

class GDALDataset;

namespace scree::gis {

struct DatasetCloser {
    void operator()(GDALDataset* dataset) const;
};
using DatasetPtr = std::unique_ptr<GDALDataset, DatasetCloser>;

enum class DatasetKind { Raster, Vector };

/// Opens a file for reading only, or throws InputError that says why it cannot be: absent, a folder, empty, a web page, a format
/// that GDAL does not know. `purpose` is how the message calls it ("terrain model", "release zones").
DatasetPtr open_dataset(const std::string& file, DatasetKind kind, const std::string& purpose, const GdalScope& scope);

/// The files on disc behind an input: of a Shapefile its parts, of a virtual raster its sources, of a folder what lies in it, else the file itself.
/// With the log of a GeoPackage that is open elsewhere (-wal). Without overviews and the statistics (.aux.xml that holds nothing else) that a GIS writes beside a raster
/// when it shows it.
std::vector<std::string> files_behind(const std::string& input);

/// A file that was read, and the SHA-256 that it had then, as sha256sum prints it.
struct InputFile {
    std::string path;
    std::string sha256;
};

/// The files behind several inputs, each once, in their order, hashed now: to be asked for when they are read, for a file may change before results are
/// written. Also of files that GDAL reads out of an archive. Throws InputError where there is no file on disc.
std::vector<InputFile> input_files(const std::vector<std::string>& inputs);

/// "GDAL 3.6.2, PROJ 9.1.1": those that are in use, on which transformations depend.
std::string library_versions();

}  // namespace scree::gis
