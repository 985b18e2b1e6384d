// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/dtm_reader.hpp"

#include "gis/crs.hpp"
#include "gis/dataset.hpp"
#include "gis/utf8.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>

namespace scree::gis {

namespace {

constexpr double kOriginStep = 100.0;  // the local origin is a multiple of this [m]
constexpr double kRotationTolerance =
    0.01;  // drift of a row or column over the whole raster that is no rotation yet [cells]
constexpr std::int64_t kStripCells = 1 << 22;  // cells read at a time [-]
constexpr double kSpike = 20.0,
                 kLeastSpike = 10.0;  // height that no single cell has over all its neighbours [cells], [m]
constexpr double kSparse = 0.1;       // share of valid cells below which a warning is given [-]
constexpr double kMinus99 = -99.0;    // stands for "no height" in some files [m]
constexpr double kLowCliff = 10.0;    // zeros this far below all other heights may be such holes, or water [m]
constexpr double kZeroCliff = 100.0;  // zeros this far below all other heights are holes filled with 0 [m]

// Values that programs write where they know nothing.
constexpr std::array kSentinels = {-99.0,
                                   -999.0,
                                   -9999.0,
                                   -99999.0,
                                   -999999.0,
                                   -32767.0,
                                   -32768.0,
                                   -2147483648.0,
                                   9999.0,
                                   32767.0,
                                   65535.0,
                                   99999.0,
                                   1e20,
                                   -1e10,
                                   -1e20,
                                   -1e30,
                                   1e30,
                                   -3.4028234663852886e38,
                                   3.4028234663852886e38};

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
    throw InputError(words("The terrain model '", file, "' ", what));
}

double round_down(double value) {
    return std::floor(value / kOriginStep) * kOriginStep;
}

// How the rows and columns of the file map to the ground: axis-parallel, either direction.
struct Placement {
    double west = 0, north = 0;  // map frame [m]
    double dx = 1, dy = 1;       // [m]
    bool flip_columns = false;   // columns run from east to west
    bool south_up = false;       // rows run from south to north
};

struct HeightBands {
    GDALRasterBand* heights = nullptr;
    GDALRasterBand* alpha = nullptr;  // 0 where there is no height; none if there is no such band
};

HeightBands height_bands(GDALDataset& dataset, const std::string& file) {
    const int bands = dataset.GetRasterCount();
    if (bands == 0) {
        std::string list;
        char** sub = dataset.GetMetadata("SUBDATASETS");
        for (int i = 1; const char* name = CSLFetchNameValue(sub, words("SUBDATASET_", i, "_NAME").c_str()); ++i) {
            std::string from_anywhere = name;
            if (const std::size_t at = from_anywhere.find(file); at != std::string::npos)
                from_anywhere.replace(at, file.size(), std::filesystem::absolute(file).lexically_normal().string());
            list += words(i > 1 ? ", " : "", "'", from_anywhere, "'");
        }
        refuse(file, list.empty() ? "has no raster band; name a raster of heights."
                                  : "holds several rasters; name one of them: " + list + ".");
    }
    HeightBands found;
    int heights = 0;
    for (int b = 1; b <= bands; ++b) {
        GDALRasterBand* band = dataset.GetRasterBand(b);
        const bool alpha = band->GetColorInterpretation() == GCI_AlphaBand;
        (alpha ? found.alpha : found.heights) = band;
        heights += !alpha;
    }
    if (heights == 0) refuse(file, "has an alpha band only; name a raster of heights.");
    if (heights != 1) {
        refuse(file,
               words("has ", bands,
                     " bands, but a terrain model has one, of heights; is it a picture? If one band holds the heights, "
                     "take it out with gdal_translate -b 1 in.tif out.tif."));
    }
    return found;
}

void check_size(GDALDataset& dataset, const std::string& file, const DtmSettings& settings) {
    const std::int64_t columns = dataset.GetRasterXSize(), rows = dataset.GetRasterYSize();
    if (columns < 2 || rows < 2) {
        refuse(file, words("has ", columns, " x ", rows,
                           " cells, too few for a surface (at least 2 x 2); name the full raster."));
    }
    if (columns > settings.max_cells / rows) {
        refuse(file, words("claims ", columns, " x ", rows, " cells, more than the ", settings.max_cells,
                           " that are allowed; cut out the site "
                           "with gdal_translate -projwin, or make it coarser with gdalwarp -tr."));
    }
}

void check_unit(GDALRasterBand& band, const std::string& file) {
    std::string unit = band.GetUnitType() ? band.GetUnitType() : "";
    const std::string lower = lower_case(unit);
    for (const char* metre : {"", "m", "metre", "metres", "meter", "meters", "unknown", "unity"}) {
        if (lower == metre) return;
    }
    const bool feet = lower.find("ft") != std::string::npos || lower.find("foot") != std::string::npos ||
                      lower.find("feet") != std::string::npos;
    refuse(file, words("has heights in '", unit, "', but they must be in metres; ",
                       feet ? "convert them with gdal_calc.py -A in.tif --calc=A*0.3048 --outfile=out.tif (US survey "
                              "feet: A*0.3048006096)"
                            : "convert them, or set the unit with gdal_edit.py if they are in metres",
                       "."));
}

// Reads the first cell: that tells many damaged files before memory is taken for all cells. Not the last one: some readers of text
// formats work their way to a far row recursively and never come back from a file that ends early.
void probe_first_cell(GDALRasterBand& band, const std::string& file, const GdalScope& scope) {
    double value = 0;
    if (band.RasterIO(GF_Read, 0, 0, 1, 1, &value, 1, 1, GDT_Float64, 0, 0, nullptr) == CE_None) return;
    refuse(file, words("is damaged or incomplete: not even its first cell can be read", scope.reason(),
                       "; copy or download it again."));
}

Placement placement_of(GDALDataset& dataset, const std::string& file) {
    std::array<double, 6> g{};
    const bool found = dataset.GetGeoTransform(g.data()) == CE_None;
    // some formats answer with the identity where they have none
    if (!found || g == std::array<double, 6>{0, 1, 0, 0, 0, 1}) {
        const char* but =
            dataset.GetGCPCount() > 0 ? "is georeferenced by ground control points only" : "has no georeference";
        refuse(file, words(but, ", but the position and size of its cells are needed; ",
                           dataset.GetGCPCount() > 0
                               ? "warp it with gdalwarp -t_srs to a projected CRS in metres."
                               : "find the original, its world file, or set it with gdal_translate -a_ullr."));
    }
    for (const double v : g) {
        if (!std::isfinite(v)) refuse(file, "has a georeference with values that are not finite; find the original.");
    }
    const int columns = dataset.GetRasterXSize(), rows = dataset.GetRasterYSize();
    if (g[1] == 0 && g[2] == 0)
        refuse(file, "has cells without a width; find the original, or set it with gdal_edit.py -tr.");
    if (g[1] == 0 || g[5] == 0 || std::abs(g[4]) * columns > kRotationTolerance * std::abs(g[5]) ||
        std::abs(g[2]) * rows > kRotationTolerance * std::abs(g[1])) {
        refuse(file, words("is rotated by ", fixed(std::atan2(g[4], g[1]) * 180 / std::numbers::pi, 2),
                           " degrees or sheared, but its rows must "
                           "run west to east; resample it with gdalwarp -r bilinear in.tif out.tif."));
    }
    Placement p;
    p.dx = std::abs(g[1]);
    p.dy = std::abs(g[5]);
    p.flip_columns = g[1] < 0;
    p.south_up = g[5] > 0;
    p.west = p.flip_columns ? g[0] + columns * g[1] : g[0];
    p.north = p.south_up ? g[3] + rows * g[5] : g[3];
    return p;
}

// A raster without a CRS whose cells are tiny and whose corners are possible longitudes and latitudes.
void refuse_unlabelled_degrees(const Placement& p, int columns, int rows, const std::string& file) {
    const double east = p.west + columns * p.dx, south = p.north - rows * p.dy;
    if (p.dx < 0.1 && p.dy < 0.1 && p.west >= -180 && east <= 360 && south >= -90 && p.north <= 90) {
        refuse(
            file,
            words("has no coordinate reference system and seems to be in degrees (cells of ", p.dx, ", from ", p.west,
                  ", ", south, " to ", east, ", ", p.north,
                  "), but a map in metres is needed; reproject it with gdalwarp -s_srs EPSG:4326 -t_srs EPSG:code."));
    }
}

// Values of the band as numbers: scale, offset, and all the ways to say "no value".
class Decoder {
public:
    explicit Decoder(const HeightBands& bands) : band_(*bands.heights), mask_(bands.alpha) {
        GDALRasterBand& band = band_;
        int has = 0;
        scale_ = band.GetScale(&has);
        offset_ = band.GetOffset(&has);
        const GDALDataType type = band.GetRasterDataType();
        if (type == GDT_Int64) {
            const auto value = band.GetNoDataValueAsInt64(&has);
            if (has) nodata_ = static_cast<double>(value);
        } else if (type == GDT_UInt64) {
            const auto value = band.GetNoDataValueAsUInt64(&has);
            if (has) nodata_ = static_cast<double>(value);
        } else {
            const double value = band.GetNoDataValue(&has);
            if (has) nodata_ = value;
            // the tag may hold more digits than the pixels of a 4-byte raster
            constexpr double kFloatMax = std::numeric_limits<float>::max();
            if (has && type == GDT_Float32 && std::isfinite(value)) {
                nodata_ = static_cast<double>(static_cast<float>(std::clamp(value, -kFloatMax, kFloatMax)));
            }
        }
        // GDAL takes no alpha band of real numbers for a mask
        if (!mask_ && band.GetMaskFlags() != GMF_ALL_VALID) mask_ = band.GetMaskBand();
    }

    bool scaled() const { return scale_ != 1 || offset_ != 0; }
    double scale() const { return scale_; }
    double offset() const { return offset_; }
    // Cells that are NaN in the file although no tag says that NaN means nodata.
    std::size_t untagged_nan() const { return untagged_nan_; }

    // Rows [first, first + count) of the file, all columns; false if they cannot be read.
    bool read(int first, int count, std::vector<double>& values) {
        const int columns = band_.GetXSize();
        values.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(count));
        if (band_.RasterIO(GF_Read, 0, first, columns, count, values.data(), columns, count, GDT_Float64, 0, 0,
                           nullptr) != CE_None)
            return false;
        if (mask_) {
            visible_.resize(values.size());
            if (mask_->RasterIO(GF_Read, 0, first, columns, count, visible_.data(), columns, count, GDT_Float32, 0, 0,
                                nullptr) != CE_None)
                return false;
        }
        const bool nan_is_tagged = nodata_ && std::isnan(*nodata_);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const bool hidden = mask_ && !(visible_[i] > 0);
            if (!hidden && !nan_is_tagged && std::isnan(values[i])) ++untagged_nan_;
            values[i] = hidden || (nodata_ && values[i] == *nodata_) ? kNaN : values[i] * scale_ + offset_;
        }
        return true;
    }

private:
    GDALRasterBand& band_;
    double scale_ = 1, offset_ = 0;
    std::optional<double> nodata_;
    GDALRasterBand* mask_;  // 0 where there is no height; none if all cells have one
    std::size_t untagged_nan_ = 0;
    std::vector<float> visible_;
};

// What is learned about the heights while they are read.
struct HeightCensus {
    std::size_t valid = 0, zeros = 0, infinite = 0, outside = 0,
                like_first = 0;  // like_first: outside, of the first such value
    double min = kInfinity, max = -kInfinity, min_nonzero = kInfinity, min_but_99 = kInfinity;  // [m]
    bool integral = true;
    double bad_value = 0;                                                    // first infinite or outside value [m]
    std::size_t bad_row = 0, bad_column = 0, zero_row = 0, zero_column = 0;  // in the file, from 0

    void add(double z, std::size_t row, std::size_t column, const DtmSettings& settings) {
        if (std::isnan(z)) return;
        const bool is_infinite = std::isinf(z), is_outside = z < settings.lowest_height || z > settings.highest_height;
        if (is_infinite || is_outside) {
            if (infinite + outside == 0) bad_value = z, bad_row = row, bad_column = column;
            like_first += z == bad_value;
            infinite += is_infinite;
            outside += !is_infinite;
            return;
        }
        ++valid;
        min = std::min(min, z);
        max = std::max(max, z);
        integral = integral && z == std::floor(z);
        if (z != kMinus99) min_but_99 = std::min(min_but_99, z);
        if (z != 0)
            min_nonzero = std::min(min_nonzero, z);
        else if (++zeros == 1)
            zero_row = row, zero_column = column;
    }
};

void check_heights(const HeightCensus& census, const std::string& file, const DtmSettings& settings) {
    const auto at = [](std::size_t column, std::size_t row) {
        return words("(first at column ", column + 1, ", row ", row + 1, ")");
    };
    if (census.infinite > 0 || census.outside > 0) {
        const double value = census.bad_value;
        const std::size_t count = census.infinite + census.outside;
        if (std::isinf(value)) {
            refuse(file, words("has ", counted(count, "cell"), " with an infinite or impossible height, ",
                               value > 0 ? "+" : "-", "infinity ", at(census.bad_column, census.bad_row),
                               "; set them to nodata, for example with gdal_calc.py "
                               "--calc=\"where(isinf(A),-9999,A)\" --NoDataValue=-9999."));
        }
        if (2 * census.like_first < count)
            refuse(file,
                   words("has ", counted(count, "cell"), " with heights outside of [", settings.lowest_height, ", ",
                         settings.highest_height, "] m, ", value, " m ", at(census.bad_column, census.bad_row),
                         " and many others: are they in centimetres or feet? Bring them to metres, for example "
                         "with gdal_translate -ot Float32 -scale 0 100 0 1 in.tif out.tif."));
        const bool sentinel = std::any_of(kSentinels.begin(), kSentinels.end(),
                                          [&](double s) { return std::abs(value - s) <= 1e-6 * std::abs(s); });
        refuse(
            file,
            words("has ", counted(count, "cell"), " with heights outside of [", settings.lowest_height, ", ",
                  settings.highest_height, "] m, ", value, " m ", at(census.bad_column, census.bad_row),
                  sentinel || std::abs(value) > 1e5
                      ? "; this looks like a nodata value without its tag: set the tag with gdal_translate -a_nodata "
                      : "; if this means \"no height\", set the tag with gdal_translate -a_nodata ",
                  value, " in.tif out.tif."));
    }
    if (census.valid < 4) {
        refuse(file, words("has ", counted(census.valid, "cell"),
                           " with a height, too few for a surface (at least 4); all others are nodata."));
    }
    const std::size_t others = census.valid - census.zeros;
    if (census.zeros > 0 && others > 0 && census.min_nonzero > kZeroCliff) {
        refuse(file, words("has ", counted(census.zeros, "cell"), " of height 0 ",
                           at(census.zero_column, census.zero_row), " while all others are above ", census.min_nonzero,
                           " m; they look like holes filled with zero: set the tag with "
                           "gdal_translate -a_nodata 0 in.tif out.tif."));
    }
    // -99 is a possible height, but not a hundred metres below all the others
    if (census.min == kMinus99 && (census.max > kZeroCliff || census.min_but_99 > kMinus99 + kZeroCliff)) {
        refuse(file,
               "has cells of height -99 m far below its other heights; if this means \"no height\", set the tag with "
               "gdal_translate -a_nodata -99 in.tif out.tif.");
    }
}

HeightCensus read_heights(Decoder& decoder, const Placement& place, const std::string& file,
                          const DtmSettings& settings, const GdalScope& scope, Dtm& dtm) {
    HeightCensus census;
    const auto columns = static_cast<std::size_t>(dtm.columns);
    dtm.heights.assign(columns * static_cast<std::size_t>(dtm.rows), kNaN);
    const int strip = static_cast<int>(std::clamp<std::int64_t>(kStripCells / dtm.columns, 1, dtm.rows));
    std::vector<double> values;
    for (int first = 0; first < dtm.rows; first += strip) {
        const int count = std::min(strip, dtm.rows - first);
        if (!decoder.read(first, count, values)) {
            const std::string reason = scope.reason();
            int row = first;
            while (row + 1 < first + count && decoder.read(row, 1, values)) ++row;
            refuse(file, words("is damaged or incomplete: pixels of its row ", row + 1, " (of ", dtm.rows,
                               "), and maybe of others, cannot be read", reason, "; copy or download it again."));
        }
        for (int r = 0; r < count; ++r) {
            const int row = place.south_up ? first + r : dtm.rows - 1 - (first + r);
            for (std::size_t c = 0; c < columns; ++c) {
                const double z = values[static_cast<std::size_t>(r) * columns + c];
                census.add(z, static_cast<std::size_t>(first + r), c, settings);
                dtm.heights[static_cast<std::size_t>(row) * columns + (place.flip_columns ? columns - 1 - c : c)] = z;
            }
        }
    }
    return census;
}

/// Single cells far above or far below all eight around them: birds, wires and gross errors, which blocks would meet.
void warn_of_spikes(Dtm& dtm, const std::string& place) {
    const double far = std::max(kLeastSpike, kSpike * std::max(dtm.dx, dtm.dy));
    std::size_t count = 0;
    int first_column = 0, first_row = 0;
    double first = 0.0;
    for (int row = dtm.rows - 2; row > 0; --row)
        for (int column = 1; column + 1 < dtm.columns; ++column) {
            const double z = dtm.at(column, row);
            double low = kInfinity, high = -kInfinity;
            for (int r = row - 1; r <= row + 1; ++r)
                for (int c = column - 1; c <= column + 1; ++c) {
                    if (r == row && c == column) continue;
                    low = std::min(low, dtm.at(c, r));
                    high = std::max(high, dtm.at(c, r));
                }
            const double by = std::max(z - high, low - z);
            if (!(by > far)) continue;
            if (++count == 1) first_column = column, first_row = row, first = by;
        }
    if (count > 0)
        dtm.report.warnings.push_back(words(place, " has ", counted(count, "cell"), " more than ", far,
                                            " m above or below all eight around (the first by ", fixed(first, 1),
                                            " m, in column ", first_column + 1, " from the west and row ",
                                            dtm.rows - first_row,
                                            " from the north): errors of the survey? Blocks meet them; mend them, for "
                                            "example with gdal_fillnodata.py."));
}

/// Cells without a height that have ground all around: blocks that come there are lost. What lies outside of a survey reaches the edge of the raster.
void warn_of_holes(Dtm& dtm, const std::string& place) {
    const auto columns = static_cast<std::size_t>(dtm.columns), rows = static_cast<std::size_t>(dtm.rows);
    std::vector<char> outside(dtm.heights.size(), 0);
    std::vector<std::size_t> open;
    const auto reach = [&](std::size_t column, std::size_t row) {
        const std::size_t cell = row * columns + column;
        if (outside[cell] || !std::isnan(dtm.heights[cell])) return;
        outside[cell] = 1;
        open.push_back(cell);
    };
    for (std::size_t column = 0; column < columns; ++column) reach(column, 0), reach(column, rows - 1);
    for (std::size_t row = 0; row < rows; ++row) reach(0, row), reach(columns - 1, row);
    while (!open.empty()) {
        const std::size_t column = open.back() % columns, row = open.back() / columns;
        open.pop_back();
        for (std::size_t r = row - (row > 0); r <= std::min(row + 1, rows - 1); ++r)
            for (std::size_t c = column - (column > 0); c <= std::min(column + 1, columns - 1); ++c) reach(c, r);
    }
    std::size_t count = 0, first = 0;
    for (std::size_t cell = dtm.heights.size(); cell-- > 0;)  // from the north, as files are
        if (std::isnan(dtm.heights[cell]) && !outside[cell] && ++count == 1) first = cell;
    if (count > 0)
        dtm.report.warnings.push_back(words(
            place, " has ", counted(count, "cell"), " without a height amid others (one in column ",
            first % columns + 1, " from the west and row ", rows - first / columns,
            " from the north): blocks that come there have left the terrain; fill what is no abyss, for example with "
            "gdal_fillnodata.py."));
}

void add_warnings(const HeightCensus& census, const Decoder& decoder, const GdalScope& scope, Dtm& dtm) {
    DtmReport& report = dtm.report;
    const std::string place = words("The terrain model '", report.file, "'");
    warn_of_spikes(dtm, place);
    warn_of_holes(dtm, place);
    if (decoder.scaled()) {
        report.warnings.push_back(words(place, " stores scaled heights: height = stored value * ", decoder.scale(),
                                        " + ", decoder.offset(), " m was applied."));
    }
    if (census.integral && census.max - census.min >= 1) {
        report.warnings.push_back(words(
            place, " has heights in whole metres: its slopes are terraces of ", fixed(1 / std::max(dtm.dx, dtm.dy), 2),
            " m per metre, and blocks will bounce on steps that do not exist; use a raster of real numbers."));
    }
    if (census.zeros > 0 && census.zeros < census.valid && census.min_nonzero > kLowCliff) {
        report.warnings.push_back(words(place, " has ", counted(census.zeros, "cell"),
                                        " of height 0 while all others are above ", census.min_nonzero,
                                        " m: if they are holes filled with zero and no water, set the tag with "
                                        "gdal_translate -a_nodata 0 in.tif out.tif."));
    }
    if (census.max == census.min) {
        report.warnings.push_back(
            words(place, " has the same height in all its cells, ", census.min, " m: is it the band that was meant?"));
    }
    if (decoder.untagged_nan() > 0) {
        report.warnings.push_back(words(place, " has ", counted(decoder.untagged_nan(), "cell"),
                                        " of NaN without a nodata tag, taken as holes."));
    }
    if (report.valid_fraction < kSparse) {
        report.warnings.push_back(
            words(place, " has a height in only ", fixed(100 * report.valid_fraction, 1), " % of its cells."));
    }
    for (const std::string& message : scope.messages())
        report.warnings.push_back(words(place, ": GDAL says: ", message));
}

}  // namespace

Dtm read_dtm(const std::string& file, const DtmSettings& settings) {
    const GdalScope scope;
    const DatasetPtr dataset = open_dataset(file, DatasetKind::Raster, "terrain model", scope);
    const HeightBands bands = height_bands(*dataset, file);
    GDALRasterBand& band = *bands.heights;
    check_size(*dataset, file, settings);
    if (GDALDataTypeIsComplex(band.GetRasterDataType())) {
        refuse(file, words("holds complex numbers (", GDALGetDataTypeName(band.GetRasterDataType()),
                           "), but heights are real numbers; is it a radar "
                           "image? Name a raster of heights."));
    }

    Dtm dtm;
    dtm.columns = dataset->GetRasterXSize();
    dtm.rows = dataset->GetRasterYSize();
    dtm.report.file = file;
    dtm.report.driver = dataset->GetDriverName();
    dtm.report.data_type = GDALGetDataTypeName(band.GetRasterDataType());

    // where it lies
    const Placement place = placement_of(*dataset, file);
    const Vec2 centre{place.west + 0.5 * dtm.columns * place.dx, place.north - 0.5 * dtm.rows * place.dy};
    const HorizontalCrs crs = metric_crs_or_throw(dataset->GetSpatialRef(), centre,
                                                  words("The terrain model '", file, "'"), dtm.report.warnings);
    if (crs.wkt.empty()) refuse_unlabelled_degrees(place, dtm.columns, dtm.rows, file);
    check_unit(band, file);
    dtm.report.crs_name = crs.name;
    dtm.dx = place.dx;
    dtm.dy = place.dy;

    // what it says
    probe_first_cell(band, file, scope);
    Decoder decoder(bands);
    if (decoder.scale() == 0.0 || !std::isfinite(decoder.scale()) || !std::isfinite(decoder.offset()))
        refuse(file, words("stores heights with the scale ", decoder.scale(), " and the offset ", decoder.offset(),
                           ", which leave nothing of them; set the tags right, for example with gdal_edit.py -scale 1 "
                           "-offset 0 in.tif."));
    const HeightCensus census = read_heights(decoder, place, file, settings, scope, dtm);
    check_heights(census, file, settings);
    dtm.report.south_west = {place.west, place.north - dtm.rows * place.dy};
    dtm.report.north_east = {place.west + dtm.columns * place.dx, place.north};
    dtm.report.cell_x = dtm.dx;
    dtm.report.cell_y = dtm.dy;
    dtm.report.valid_fraction = static_cast<double>(census.valid) / static_cast<double>(dtm.heights.size());
    dtm.report.min_height = census.min;
    dtm.report.max_height = census.max;
    add_warnings(census, decoder, scope, dtm);

    dtm.frame = {round_down(place.west), round_down(place.north - dtm.rows * place.dy), round_down(census.min),
                 crs.wkt};
    dtm.north_west = {place.west - dtm.frame.easting, place.north - dtm.frame.northing};
    for (double& z : dtm.heights) z -= dtm.frame.height;
    return dtm;
}

}  // namespace scree::gis
