// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace scree::gis {

class Database;

/// The rectangle around a feature, or around a node of the index: outwards to the next float, as SQLite stores it.
struct IndexEntry {
    std::int64_t id = 0;  ///< feature id, or number of the node [-]
    float min_x = 0;      ///< [m]
    float max_x = 0;      ///< [m]
    float min_y = 0;      ///< [m]
    float max_y = 0;      ///< [m]
};

/// Rounded outwards: the stored rectangle holds the true one.
IndexEntry index_entry(std::int64_t id, double min_x, double max_x, double min_y, double max_y);

/// Gives a layer of a GeoPackage (key `fid`, geometry `geom`) its spatial index, packed at once: many times as fast as inserting
/// row by row, and smaller. Registers it and adds the triggers that keep it up to date when somebody edits the layer.
void write_spatial_index(Database& database, const std::string& table, std::vector<IndexEntry> entries);

}  // namespace scree::gis
