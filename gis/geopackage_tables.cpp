// SPDX-License-Identifier: GPL-3.0-or-later
// OGC 12-128r17, GeoPackage Encoding Standard 1.3: contents (1.1.3), extensions (2.3), attributes (2.4), metadata (F.8),
// schema (F.9).
#include "gis/geopackage_tables.hpp"

#include "gis/database.hpp"
#include "gis/output_scope.hpp"
#include "gis/xml.hpp"

#include <initializer_list>
#include <string_view>

namespace scree::gis {

namespace {

/// INSERT with a text for each question mark.
void insert(Database& db, const std::string& sql, std::initializer_list<std::string_view> values) {
    Statement statement = db.prepare(sql);
    int place = 0;
    for (const std::string_view value : values) statement.bind(++place, value);
    statement.run();
}

/// A table that is neither map nor raster, made known to the GeoPackage.
void register_attributes(Database& db, const std::string& table, const std::string& description) {
    const std::string now = kFixedTimestamp;
    insert(db,
           "INSERT INTO gpkg_contents (table_name, data_type, identifier, description, last_change, srs_id)"
           " VALUES (?1, 'attributes', ?1, ?2, ?3, 0)",
           {table, description, now});
}

// --- styles ---

void write_styles(Database& db, std::span<const VectorLayer> layers, std::span<const WrittenLayer> written) {
    db.run(
        "CREATE TABLE layer_styles (id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, f_table_catalog TEXT(256),"
        " f_table_schema TEXT(256), f_table_name TEXT(256), f_geometry_column TEXT(256), styleName TEXT(30), styleQML "
        "TEXT,"
        " styleSLD TEXT, useAsDefault BOOLEAN, description TEXT, owner TEXT(30), ui TEXT(30),"
        " update_time DATETIME DEFAULT CURRENT_TIMESTAMP)");
    register_attributes(db, "layer_styles", "Styles that QGIS applies when it opens the layers");
    const std::string now = kFixedTimestamp;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const VectorLayer& layer = layers[i];
        const std::string column = layer.data.kind == GeometryKind::None ? "" : "geom";
        for (std::size_t k = 0; k < written[i].styles.size(); ++k) {
            const VectorStyle& style = written[i].styles[k];
            const std::string qml = qml_document(vector_qgis_style(layer, style, written[i].colour_ranges[k]));
            const std::string is_default = k == 0 ? "1" : "0";
            // the schema must be '': QGIS does not find a style whose schema is NULL
            insert(
                db,
                "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName,"
                " styleQML, styleSLD, useAsDefault, description, owner, update_time)"
                " VALUES ('', '', ?1, ?2, ?3, ?4, '', CAST(?5 AS INTEGER), ?6, '', ?7)",
                {layer.data.name, column, style.name, qml, is_default, layer.description, now});
        }
    }
}

// --- aliases ---

void write_aliases(Database& db, std::span<const VectorLayer> layers) {
    db.run(
        "CREATE TABLE gpkg_data_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL, name TEXT, title TEXT,"
        " description TEXT, mime_type TEXT, constraint_name TEXT, CONSTRAINT pk_gdc PRIMARY KEY (table_name, "
        "column_name),"
        " CONSTRAINT gdc_tn UNIQUE (table_name, name))");
    db.run(
        "CREATE TABLE gpkg_data_column_constraints (constraint_name TEXT NOT NULL, constraint_type TEXT NOT NULL, "
        "value TEXT,"
        " min NUMERIC, min_is_inclusive BOOLEAN, max NUMERIC, max_is_inclusive BOOLEAN, description TEXT,"
        " CONSTRAINT gdcc_ntv UNIQUE (constraint_name, constraint_type, value))");
    const std::string definition = "http://www.geopackage.org/spec121/#extension_schema";
    register_extension(db, "gpkg_data_columns", "", "gpkg_schema", definition, "read-write");
    register_extension(db, "gpkg_data_column_constraints", "", "gpkg_schema", definition, "read-write");
    for (const VectorLayer& layer : layers) {
        for (const Field& field : layer.data.fields) {
            if (field.alias.empty()) continue;
            insert(db, "INSERT INTO gpkg_data_columns (table_name, column_name, name, title) VALUES (?1, ?2, ?2, ?3)",
                   {layer.data.name, field.name, field.alias});
        }
    }
}

// --- provenance ---

std::string character_string(const std::string& text) {
    return "<gco:CharacterString>" + xml_text(text) + "</gco:CharacterString>";
}

/// The smallest metadata record that ISO 19139 allows, with the provenance as lineage.
std::string lineage_record(const std::string& title, std::span<const ProvenanceEntry> provenance) {
    std::string statement;
    for (const ProvenanceEntry& entry : provenance) statement += entry.key + ": " + entry.value + "\n";
    const std::string code_list = "http://www.isotc211.org/2005/resources/Codelist/gmxCodelists.xml#";
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
           "<gmd:MD_Metadata xmlns:gmd=\"http://www.isotc211.org/2005/gmd\" "
           "xmlns:gco=\"http://www.isotc211.org/2005/gco\">\n"
           "<gmd:contact gco:nilReason=\"missing\"/>\n"
           "<gmd:dateStamp gco:nilReason=\"withheld\"/>\n"
           "<gmd:identificationInfo><gmd:MD_DataIdentification><gmd:citation><gmd:CI_Citation>\n<gmd:title>" +
           character_string(title) +
           "</gmd:title>\n<gmd:date gco:nilReason=\"withheld\"/>\n</gmd:CI_Citation></gmd:citation>\n<gmd:abstract>" +
           character_string("Simulated rockfall: where blocks pass, how fast and high, where they stop") +
           "</gmd:abstract>\n<gmd:language>" + character_string("eng") +
           "</gmd:language>\n</gmd:MD_DataIdentification></gmd:identificationInfo>\n"
           "<gmd:dataQualityInfo><gmd:DQ_DataQuality><gmd:scope><gmd:DQ_Scope><gmd:level><gmd:MD_ScopeCode "
           "codeList=\"" +
           code_list +
           "MD_ScopeCode\" "
           "codeListValue=\"dataset\">dataset</gmd:MD_ScopeCode></gmd:level></gmd:DQ_Scope></gmd:scope>\n" +
           "<gmd:lineage><gmd:LI_Lineage><gmd:statement>" + character_string(statement) +
           "</gmd:statement></gmd:LI_Lineage></gmd:lineage>\n</gmd:DQ_DataQuality></gmd:dataQualityInfo>\n</"
           "gmd:MD_Metadata>\n";
}

void write_provenance(Database& db, const std::string& title, std::span<const ProvenanceEntry> provenance) {
    db.run("CREATE TABLE run (id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, key TEXT NOT NULL, value TEXT NOT NULL)");
    register_attributes(db, "run", "How this result came about: settings, version, seed, inputs, counts");
    for (const ProvenanceEntry& entry : provenance) {
        insert(db, "INSERT INTO run (key, value) VALUES (?1, ?2)", {entry.key, entry.value});
    }

    // GDAL may have made the tables for metadata of rasters
    db.run(
        "CREATE TABLE IF NOT EXISTS gpkg_metadata (id INTEGER CONSTRAINT m_pk PRIMARY KEY ASC NOT NULL,"
        " md_scope TEXT NOT NULL DEFAULT 'dataset', md_standard_uri TEXT NOT NULL,"
        " mime_type TEXT NOT NULL DEFAULT 'text/xml', metadata TEXT NOT NULL DEFAULT '')");
    db.run(
        "CREATE TABLE IF NOT EXISTS gpkg_metadata_reference (reference_scope TEXT NOT NULL, table_name TEXT, "
        "column_name TEXT,"
        " row_id_value INTEGER, timestamp DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),"
        " md_file_id INTEGER NOT NULL, md_parent_id INTEGER,"
        " CONSTRAINT crmr_mfi_fk FOREIGN KEY (md_file_id) REFERENCES gpkg_metadata(id),"
        " CONSTRAINT crmr_mpi_fk FOREIGN KEY (md_parent_id) REFERENCES gpkg_metadata(id))");
    const std::string definition = "http://www.geopackage.org/spec121/#extension_metadata";
    register_extension(db, "gpkg_metadata", "", "gpkg_metadata", definition, "read-write");
    register_extension(db, "gpkg_metadata_reference", "", "gpkg_metadata", definition, "read-write");
    const std::string record = lineage_record(title, provenance);
    const std::string now = kFixedTimestamp;
    insert(db,
           "INSERT INTO gpkg_metadata (md_scope, md_standard_uri, mime_type, metadata)"
           " VALUES ('dataset', 'http://www.isotc211.org/2005/gmd', 'text/xml', ?1)",
           {record});
    insert(db,
           "INSERT INTO gpkg_metadata_reference (reference_scope, timestamp, md_file_id)"
           " VALUES ('geopackage', ?1, (SELECT max(id) FROM gpkg_metadata))",
           {now});
}

/// Smallest and largest values of tiles are optional (OGC 17-066r1, gpkg_2d_gridded_tile_ancillary), and GDAL 3.6 takes those of all rasters of the file for each.
void forget_tile_statistics(Database& db) {
    db.run("UPDATE gpkg_2d_gridded_tile_ancillary SET min = NULL, max = NULL, mean = NULL, std_dev = NULL");
}

}  // namespace

void write_geopackage_tables(const std::filesystem::path& geopackage, const std::string& title,
                             std::span<const VectorLayer> layers, std::span<const WrittenLayer> written,
                             std::span<const ProvenanceEntry> provenance, std::size_t rasters) {
    Database db(geopackage);
    db.run("BEGIN");
    write_aliases(db, layers);
    write_styles(db, layers, written);
    write_provenance(db, title, provenance);
    if (rasters > 0) forget_tile_statistics(db);
    db.run("COMMIT");
}

}  // namespace scree::gis
