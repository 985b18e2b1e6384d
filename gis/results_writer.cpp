// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/results_writer.hpp"

#include "gis/geopackage_tables.hpp"
#include "gis/qgis_project.hpp"
#include "gis/raster_writer.hpp"
#include "gis/vector_writer.hpp"
#include "scree/base/error.hpp"

#include <array>
#include <csignal>
#include <fstream>
#include <set>

namespace scree::gis {

namespace fs = std::filesystem;

namespace {

/// Names are tables of one database and titles its identifiers: both must differ.
void check_names(const ResultsPackage& package) {
    std::set<std::string> names;
    std::set<std::string> titles = {"run", "layer_styles"};
    const auto add = [&](const std::string& name, const std::string& title) {
        if (!names.insert(name).second) {
            throw InputError("results: the layer name \"" + name + "\" is given twice; names of layers must differ");
        }
        if (!titles.insert(title).second) {
            throw InputError("results, layer " + name + ": the title \"" + title +
                             "\" is given twice; titles of layers must differ");
        }
    };
    for (const VectorLayer& layer : package.vectors) add(layer.data.name, layer_title(layer, layer.data.name));
    for (const RasterLayer& layer : package.rasters) add(layer.name, layer_title(layer, layer.name));

    std::set<std::string> files = {kGeoPackageFile, "results.qgs", "rasters", kChecksumFile};
    for (const TextFile& file : package.files) {
        const fs::path path(file.name);
        const auto is_plain = [](const fs::path& part) {
            return !part.empty() && part == part.filename() && part != "." && part != "..";
        };
        const bool plain = is_plain(path.filename()) && path.is_relative() &&
                           (path.parent_path().empty() || is_plain(path.parent_path())) &&
                           path.parent_path() != "rasters";
        if (!plain || !files.insert(file.name).second) {
            throw InputError("results: a file cannot be called \"" + file.name +
                             "\"; allowed is a name, in at most one folder, that nothing else in the results has");
        }
    }
}

void write_text(const fs::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) throw ComputeError(file.string() + ": could not be stored; check that the disc has room");
}

volatile std::sig_atomic_t waiting_signal = 0;
extern "C" void keep_signal(int signal) {
    waiting_signal = signal;
}

/// Ctrl-C and a request to end wait until results are whole: what is half written would be left behind, and lost. They are delivered then.
class SignalsWait {
public:
    SignalsWait() {
        waiting_signal = 0;
        struct sigaction keep = {};
        keep.sa_handler = keep_signal;
        keep.sa_flags = SA_RESTART;  // writing goes on
        for (std::size_t k = 0; k < kSignals.size(); ++k) sigaction(kSignals[k], &keep, &before_[k]);
    }
    ~SignalsWait() {
        for (std::size_t k = 0; k < kSignals.size(); ++k) sigaction(kSignals[k], &before_[k], nullptr);
        if (waiting_signal != 0) std::raise(waiting_signal);
    }
    SignalsWait(const SignalsWait&) = delete;
    SignalsWait& operator=(const SignalsWait&) = delete;

private:
    static constexpr std::array kSignals{SIGINT, SIGTERM};
    std::array<struct sigaction, kSignals.size()> before_{};
};

void write_into(ResultsFolder& results, const ResultsPackage& package) {
    const fs::path geopackage = results.path() / kGeoPackageFile;

    // GDAL wants the vectors of a GeoPackage before its rasters
    const std::vector<WrittenLayer> written = write_vector_layers(geopackage, package.frame, package.vectors);
    if (!package.rasters.empty()) fs::create_directory(results.path() / "rasters");
    std::vector<WrittenRaster> rasters;
    for (RasterLayer raster : package.rasters) {
        if (raster.make_values) raster.values = raster.make_values();
        append_coverage(geopackage, package.frame, raster);
        rasters.push_back(write_geotiff(results.path() / "rasters" / (raster.name + ".tif"), package.frame, raster));
    }
    write_geopackage_tables(geopackage, package.title, package.vectors, written, package.provenance,
                            package.rasters.size());
    write_text(results.path() / "results.qgs",
               qgis_project(package.frame, package.title, package.vectors, written, package.rasters, rasters));
    for (const TextFile& file : package.files) {
        fs::create_directories((results.path() / file.name).parent_path());
        write_text(results.path() / file.name, file.text);
    }
}

}  // namespace

void write_results(const fs::path& folder, const ResultsPackage& package, bool overwrite) {
    check_names(package);
    const SignalsWait wait;
    try {
        ResultsFolder results(folder, overwrite);
        write_into(results, package);
        results.commit();
    } catch (const fs::filesystem_error& error) {
        throw ComputeError(folder.string() + ": the results could not be stored: " + error.what());
    }
}

}  // namespace scree::gis
