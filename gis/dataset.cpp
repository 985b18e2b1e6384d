// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/dataset.hpp"

#include "gis/sha256.hpp"
#include "gis/utf8.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <cpl_minixml.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <proj.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

namespace scree::gis {

namespace {

// Names such as /vsizip/a.zip/b.tif or GPKG:a.gpkg:dtm are GDAL's own and not paths of the file system.
bool is_plain_path(const std::string& file) {
    return file.rfind("/vsi", 0) != 0 && file.find(':') == std::string::npos && file.find('<') == std::string::npos;
}

bool starts_like_a_web_page(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::string head(512, '\0');
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(in.gcount()));
    head = lower_case(std::move(head));
    return head.find("<html") != std::string::npos || head.find("<!doctype") != std::string::npos;
}

// Why a file cannot be opened, as far as the file itself tells; empty if it does not.
std::string trouble_with_file(const std::string& file) {
    namespace fs = std::filesystem;
    std::error_code error;
    if (!fs::exists(file, error)) return "the file does not exist; check the path";
    if (fs::is_directory(file, error)) return {};
    if (fs::file_size(file, error) == 0 && !error) return "the file is empty; copy or download it again";
    if (!std::ifstream(file)) return "the file cannot be opened for reading; check its permissions";
    if (starts_like_a_web_page(file))
        return "the content is a web page (HTML), perhaps of a login or an error; download it again";
    return {};
}

/// Whether an .aux.xml holds more than what GIS programs write for themselves whenever they show a raster: scale, nodata or CRS change what is read.
bool more_than_statistics(const std::string& file) {
    const CPLXMLTreeCloser root(CPLParseXMLFile(file.c_str()));
    std::function<bool(const CPLXMLNode*)> tells = [&](const CPLXMLNode* node) {
        for (; node; node = node->psNext) {
            const std::string name = node->eType == CXT_Element ? node->pszValue : "";
            if (name == "PAMDataset" || name == "PAMRasterBand") {
                if (tells(node->psChild)) return true;
            } else if (!name.empty() && name != "Metadata" && name != "Histograms") {
                return true;
            }
        }
        return false;
    };
    return !root || tells(root.get());
}

bool shown_only(const std::string& file) {
    return file.ends_with(".ovr") || (file.ends_with(".aux.xml") && !more_than_statistics(file));
}

std::string sha256_of_input(const std::string& file) {
    if (!file.starts_with("/vsi")) {
        if (!std::filesystem::is_regular_file(file))
            throw InputError(file +
                             ": no file on disc stands behind this input, and results hold the SHA-256 of every input; "
                             "save it as a file");
        return sha256_of_file(file);
    }
    const std::unique_ptr<VSILFILE, int (*)(VSILFILE*)> in(VSIFOpenL(file.c_str(), "rb"), VSIFCloseL);
    if (!in) throw InputError(file + ": cannot be opened for reading; check that the archive exists and has the file");
    Sha256 hash;
    std::string buffer(std::size_t{1} << 18, '\0');
    for (std::size_t read = 0; (read = VSIFReadL(buffer.data(), 1, buffer.size(), in.get())) > 0;)
        hash.update({buffer.data(), read});
    return hash.hex();
}

}  // namespace

std::vector<std::string> files_behind(const std::string& input) {
    namespace fs = std::filesystem;
    std::vector<std::string> files{input};
    std::error_code ignored;
    if (fs::is_directory(input, ignored)) {
        files.clear();
        for (const auto& entry : fs::recursive_directory_iterator(input, ignored))
            if (entry.is_regular_file(ignored)) files.push_back(entry.path().string());
        std::sort(files.begin(), files.end());
        return files;
    }
    const GdalScope scope;
    DatasetPtr dataset(GDALDataset::Open(input.c_str(), GDAL_OF_READONLY | GDAL_OF_RASTER | GDAL_OF_VECTOR));
    if (!dataset) return files;  // none of GDAL's: a table, a block shape, a library
    char** list = dataset->GetFileList();
    std::vector<std::string> parts;
    for (char** part = list; part && *part; ++part)
        if (!shown_only(*part)) parts.emplace_back(*part);
    CSLDestroy(list);
    for (std::size_t k = parts.size();
         k-- > 0;) {  // what SQLite has not moved into the GeoPackage yet, as long as it is open elsewhere
        const std::string log = parts[k] + "-wal";
        if (fs::is_regular_file(log, ignored) && fs::file_size(log, ignored) > 0 &&
            std::find(parts.begin(), parts.end(), log) == parts.end())
            parts.push_back(log);
    }
    std::sort(parts.begin(), parts.end());
    const bool is_part = std::find(parts.begin(), parts.end(), input) != parts.end();
    if (!is_plain_path(input) && !parts.empty() && !is_part) files.clear();  // GPKG:a.gpkg:dtm is no file
    for (std::string& part : parts)
        if (part != input) files.push_back(std::move(part));
    return files;
}

std::vector<InputFile> input_files(const std::vector<std::string>& inputs) {
    std::vector<InputFile> all;
    for (const std::string& input : inputs)
        for (std::string& file : files_behind(input))
            if (std::none_of(all.begin(), all.end(), [&](const InputFile& f) { return f.path == file; })) {
                std::string sha256 = sha256_of_input(file);
                all.push_back({std::move(file), std::move(sha256)});
            }
    return all;
}

void DatasetCloser::operator()(GDALDataset* dataset) const {
    GDALClose(dataset);
}

DatasetPtr open_dataset(const std::string& file, DatasetKind kind, const std::string& purpose, const GdalScope& scope) {
    if (file.empty()) throw InputError(words("No file is given for the ", purpose, "; name one."));
    const std::string trouble = is_plain_path(file) ? trouble_with_file(file) : std::string();
    if (!trouble.empty()) throw InputError(words("Cannot read the ", purpose, " '", file, "': ", trouble, "."));

    const unsigned wanted = kind == DatasetKind::Raster ? GDAL_OF_RASTER : GDAL_OF_VECTOR;
    DatasetPtr dataset(GDALDataset::Open(file.c_str(), GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR | wanted));
    if (!dataset) {
        const char* form = kind == DatasetKind::Raster ? "a raster" : "a vector file";
        throw InputError(words("Cannot read the ", purpose, " '", file, "': it is not ", form,
                               " that can be opened, or it is damaged", scope.reason(), "."));
    }
    return dataset;
}

std::string library_versions() {
    return words("GDAL ", GDALVersionInfo("RELEASE_NAME"), ", PROJ ", proj_info().version);
}

}  // namespace scree::gis
