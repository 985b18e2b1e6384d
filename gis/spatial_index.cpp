// SPDX-License-Identifier: GPL-3.0-or-later
// Leutenegger, Lopez & Edgington (1997), STR: a simple and efficient algorithm for R-tree packing, ICDE: cut the rectangles into
// vertical slabs of equal number by their centres, each slab from south to north into nodes; then the nodes likewise, up to one.
// Storage: sqlite.org/rtree.html, section 8 "Shadow tables". A node is a blob of fixed size, all numbers big endian:
//     uint16 depth of the tree (root only, node 1), uint16 number of cells, cells of {int64 id, float min_x, max_x, min_y, max_y}
// Table _node: the blobs. _parent: node -> its parent. _rowid: feature -> its leaf.
// Registration and triggers: OGC 12-128r17, annex F.3, extension gpkg_rtree_index.
#include "gis/spatial_index.hpp"

#include "gis/database.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

namespace scree::gis {

namespace {

constexpr std::size_t kNodeHeader = 4;  ///< depth and number of cells [byte]
constexpr std::size_t kCellBytes = 24;  ///< id and four floats [byte]
constexpr std::int64_t kRootNode = 1;   ///< SQLite's number of the root [-]

using Node = std::span<const IndexEntry>;  ///< the entries that share a node

/// Cuts into `parts` pieces whose sizes differ by one at most.
template <class Visit>
void cut_evenly(std::span<IndexEntry> entries, std::size_t parts, Visit visit) {
    for (std::size_t i = 0; i < parts; ++i) {
        const std::size_t from = entries.size() * i / parts;
        visit(entries.subspan(from, entries.size() * (i + 1) / parts - from));
    }
}

/// Sorts the entries so that neighbours on the map are neighbours in the list, and returns the nodes they fill.
std::vector<Node> pack(std::span<IndexEntry> entries, std::size_t capacity) {
    const auto ceiling = [](std::size_t a, std::size_t b) { return (a + b - 1) / b; };
    // twice the centre, as double: exact; the id decides between equals, so that the order is unique
    const auto by_x = [](const IndexEntry& a, const IndexEntry& b) {
        const double xa = static_cast<double>(a.min_x) + static_cast<double>(a.max_x);
        const double xb = static_cast<double>(b.min_x) + static_cast<double>(b.max_x);
        return xa != xb ? xa < xb : a.id < b.id;
    };
    const auto by_y = [](const IndexEntry& a, const IndexEntry& b) {
        const double ya = static_cast<double>(a.min_y) + static_cast<double>(a.max_y);
        const double yb = static_cast<double>(b.min_y) + static_cast<double>(b.max_y);
        return ya != yb ? ya < yb : a.id < b.id;
    };
    std::vector<Node> nodes;
    const std::size_t needed = std::max<std::size_t>(1, ceiling(entries.size(), capacity));
    const auto slabs = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(needed))));
    std::ranges::sort(entries, by_x);
    cut_evenly(entries, slabs, [&](std::span<IndexEntry> slab) {
        if (slab.empty()) return;
        std::ranges::sort(slab, by_y);
        cut_evenly(slab, ceiling(slab.size(), capacity), [&](std::span<IndexEntry> node) { nodes.emplace_back(node); });
    });
    return nodes;
}

IndexEntry around(Node node, std::int64_t id) {
    IndexEntry out = node.front();
    out.id = id;
    for (const IndexEntry& entry : node) {
        out.min_x = std::min(out.min_x, entry.min_x);
        out.max_x = std::max(out.max_x, entry.max_x);
        out.min_y = std::min(out.min_y, entry.min_y);
        out.max_y = std::max(out.max_y, entry.max_y);
    }
    return out;
}

template <class Unsigned>
void append_big_endian(std::string& bytes, Unsigned value) {
    for (int shift = 8 * (static_cast<int>(sizeof value) - 1); shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<char>((value >> shift) & 0xffU));
    }
}

std::string node_blob(Node node, std::uint16_t depth, std::size_t size) {
    std::string bytes;
    bytes.reserve(size);
    append_big_endian(bytes, depth);
    append_big_endian(bytes, static_cast<std::uint16_t>(node.size()));
    for (const IndexEntry& entry : node) {
        append_big_endian(bytes, static_cast<std::uint64_t>(entry.id));
        for (const float side : {entry.min_x, entry.max_x, entry.min_y, entry.max_y}) {
            append_big_endian(bytes, std::bit_cast<std::uint32_t>(side));
        }
    }
    bytes.resize(size, '\0');
    return bytes;
}

/// Writes the nodes of all levels into the shadow tables of an empty index.
void fill(Database& database, const std::string& index, std::vector<IndexEntry> entries) {
    const auto size = static_cast<std::size_t>(
        database.prepare("SELECT length(data) FROM \"" + index + "_node\" WHERE nodeno = 1").integer());
    const std::size_t capacity = (size - kNodeHeader) / kCellBytes;
    Statement put_node =
        database.prepare("INSERT OR REPLACE INTO \"" + index + "_node\" (nodeno, data) VALUES (?1, ?2)");
    Statement put_parent =
        database.prepare("INSERT INTO \"" + index + "_parent\" (nodeno, parentnode) VALUES (?1, ?2)");
    Statement put_row = database.prepare("INSERT INTO \"" + index + "_rowid\" (rowid, nodeno) VALUES (?1, ?2)");

    std::int64_t next_number = kRootNode + 1;
    for (std::uint16_t level = 0;; ++level) {
        const std::vector<Node> nodes = pack(entries, capacity);
        const bool root = nodes.size() == 1;
        std::vector<IndexEntry> above;
        std::vector<std::pair<std::int64_t, std::int64_t>>
            homes;  // entry -> its node, written in ascending order: appends
        homes.reserve(entries.size());
        for (const Node& node : nodes) {
            const std::int64_t number = root ? kRootNode : next_number++;
            put_node.bind(1, number);
            const std::string blob = node_blob(node, root ? level : std::uint16_t{0}, size);
            put_node.bind_blob(2, blob).run();
            for (const IndexEntry& entry : node) homes.emplace_back(entry.id, number);
            above.push_back(around(node, number));
        }
        std::ranges::sort(homes);
        Statement& put_home = level == 0 ? put_row : put_parent;
        for (const auto& [entry, number] : homes) put_home.bind(1, entry).bind(2, number).run();
        if (root) return;
        entries = std::move(above);
    }
}

/// The standard's triggers, in GDAL's form.
void add_triggers(Database& database, const std::string& table) {
    const std::string index = "\"rtree_" + table + "_geom";
    const std::string on = " ON \"" + table + "\" WHEN ";
    const std::string present = "(NEW.\"geom\" NOTNULL AND NOT ST_IsEmpty(NEW.\"geom\"))";
    const std::string absent = "(NEW.\"geom\" ISNULL OR ST_IsEmpty(NEW.\"geom\"))";
    const std::string put =
        "INSERT OR REPLACE INTO " + index +
        "\" VALUES (NEW.\"fid\", ST_MinX(NEW.\"geom\"), ST_MaxX(NEW.\"geom\"), ST_MinY(NEW.\"geom\"),"
        " ST_MaxY(NEW.\"geom\")); ";
    const std::string drop = "DELETE FROM " + index + "\" WHERE id = OLD.\"fid\"; ";
    const std::string drop_both = "DELETE FROM " + index + "\" WHERE id IN (OLD.\"fid\", NEW.\"fid\"); ";
    const auto add = [&](const char* name, const char* event, const std::string& when, const std::string& action) {
        database.run("CREATE TRIGGER " + index + "_" + name + "\" AFTER " + event + on + when + " BEGIN " + action +
                     "END");
    };
    add("insert", "INSERT", present, put);
    add("update1", "UPDATE OF \"geom\"", "OLD.\"fid\" = NEW.\"fid\" AND " + present, put);
    add("update2", "UPDATE OF \"geom\"", "OLD.\"fid\" = NEW.\"fid\" AND " + absent, drop);
    add("update3", "UPDATE", "OLD.\"fid\" != NEW.\"fid\" AND " + present, drop + put);
    add("update4", "UPDATE", "OLD.\"fid\" != NEW.\"fid\" AND " + absent, drop_both);
    add("delete", "DELETE", "OLD.\"geom\" NOT NULL", drop);
}

}  // namespace

IndexEntry index_entry(std::int64_t id, double min_x, double max_x, double min_y, double max_y) {
    constexpr float kLow = -std::numeric_limits<float>::infinity();
    constexpr float kHigh = std::numeric_limits<float>::infinity();
    const auto down = [](double value) {
        const auto rounded = static_cast<float>(value);
        return static_cast<double>(rounded) > value ? std::nextafterf(rounded, kLow) : rounded;
    };
    const auto up = [](double value) {
        const auto rounded = static_cast<float>(value);
        return static_cast<double>(rounded) < value ? std::nextafterf(rounded, kHigh) : rounded;
    };
    return {id, down(min_x), up(max_x), down(min_y), up(max_y)};
}

void write_spatial_index(Database& database, const std::string& table, std::vector<IndexEntry> entries) {
    const std::string index = "rtree_" + table + "_geom";
    register_extension(database, table, "geom", "gpkg_rtree_index",
                       "http://www.geopackage.org/spec120/#extension_rtree", "write-only");
    database.run("CREATE VIRTUAL TABLE \"" + index + "\" USING rtree(id, minx, maxx, miny, maxy)");
    if (!entries.empty()) fill(database, index, std::move(entries));
    add_triggers(database, table);
}

}  // namespace scree::gis
