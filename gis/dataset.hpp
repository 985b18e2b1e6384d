// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/gdal_scope.hpp"

#include <memory>
#include <string>

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

}  // namespace scree::gis
