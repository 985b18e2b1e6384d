// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/relief.hpp"

#include "gis/output_scope.hpp"
#include "scree/base/error.hpp"
#include "scree/base/units.hpp"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_alg.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

namespace scree::gis {

namespace {

constexpr double kSunHeight = radians_from_degrees(45.0);  // [rad]
constexpr int kMostPixels = 1200;                          // a side of the image; beyond, cells are averaged
constexpr double kContourNoData = -1e30;                   // [m]

/// Columns and rows of a grid whose cells reach into a box.
struct Window {
    int column = 0, row = 0, columns = 0, rows = 0;
    bool empty() const { return columns < 2 || rows < 2; }
};

Window window_of(const GridShape& shape, const Box2& box) {
    Window w;
    const Box2 all = shape.bounds();
    if (!all.overlaps(box)) return w;
    w.column = std::clamp(shape.column_of(box.min.x()), 0, shape.columns - 1);
    w.row = std::clamp(shape.row_of(box.min.y()), 0, shape.rows - 1);
    w.columns = std::clamp(shape.column_of(box.max.x()), 0, shape.columns - 1) - w.column + 1;
    w.rows = std::clamp(shape.row_of(box.max.y()), 0, shape.rows - 1) - w.row + 1;
    return w;
}

/// Difference of heights per metre along one axis, one-sided beside a cell without height; NaN if there is none.
double difference(const Grid<double>& h, int i, int j, int di, int dj) {
    const double here = h.at(i, j);
    const double before = h.shape.contains(i - di, j - dj) ? h.at(i - di, j - dj) : kNaN;
    const double after = h.shape.contains(i + di, j + dj) ? h.at(i + di, j + dj) : kNaN;
    const bool has_before = !std::isnan(before), has_after = !std::isnan(after);
    if (!has_before && !has_after) return 0.0;
    return ((has_after ? after : here) - (has_before ? before : here)) /
           (h.shape.cell * (has_before && has_after ? 2.0 : 1.0));
}

/// Lambert's cosine with light from the north-west, mixed with the slope, so that sunny faces keep their shapes; lightened, because
/// lines and letters must stand out from it.
std::uint8_t shade(const Grid<double>& h, int i, int j) {
    const Vec3 normal = Vec3(-difference(h, i, j, 1, 0), -difference(h, i, j, 0, 1), 1.0).normalized();
    const double across = std::cos(kSunHeight) / std::sqrt(2.0);
    const double light = std::max(0.0, normal.dot(Vec3(-across, across, std::sin(kSunHeight))));
    return static_cast<std::uint8_t>(std::lround(40.0 + 140.0 * light + 75.0 * normal.z()));
}

std::string png_uri(const std::vector<std::uint8_t>& grey, const std::vector<std::uint8_t>& alpha, int columns,
                    int rows) {
    const OutputScope scope;
    const std::string where = "shaded relief";
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    GDALDriver* png = GetGDALDriverManager()->GetDriverByName("PNG");
    if (!memory || !png)
        throw ComputeError(where + ": this GDAL cannot write PNG; install GDAL with its usual drivers");
    const DatasetPtr image(memory->Create("", columns, rows, 2, GDT_Byte, nullptr));
    if (!image) scope.fail(where, "the image could not be made");
    image->GetRasterBand(2)->SetColorInterpretation(GCI_AlphaBand);
    for (const int band : {1, 2}) {
        const auto& values = band == 1 ? grey : alpha;
        if (image->GetRasterBand(band)->RasterIO(GF_Write, 0, 0, columns, rows,
                                                 const_cast<std::uint8_t*>(values.data()), columns, rows, GDT_Byte, 0,
                                                 0, nullptr) != CE_None)
            scope.fail(where, "the image could not be filled");
    }
    const std::string name = "/vsimem/scree_relief.png";
    DatasetPtr written(png->CreateCopy(name.c_str(), image.get(), FALSE, nullptr, nullptr, nullptr));
    if (!written) scope.fail(where, "the image could not be encoded");
    written.reset();
    vsi_l_offset size = 0;
    const std::unique_ptr<GByte, decltype(&VSIFree)> bytes(VSIGetMemFileBuffer(name.c_str(), &size, TRUE), VSIFree);
    VSIUnlink((name + ".aux.xml").c_str());
    if (!bytes) scope.fail(where, "the encoded image could not be read");
    const std::unique_ptr<char, decltype(&VSIFree)> text(CPLBase64Encode(static_cast<int>(size), bytes.get()), VSIFree);
    return std::string("data:image/png;base64,") + text.get();
}

struct ContourSink {
    std::vector<Contour>* lines;
    Vec2 origin;  // of the first row and column, north-west corner [m]
    double cell;  // [m]
};

CPLErr take_contour(double level, int count, double* x, double* y, void* sink) {
    auto& s = *static_cast<ContourSink*>(sink);
    Contour contour;
    contour.height = level;
    for (int k = 0; k < count; ++k)
        contour.points.emplace_back(s.origin.x() + s.cell * x[k], s.origin.y() - s.cell * y[k]);
    s.lines->push_back(std::move(contour));
    return CE_None;
}

}  // namespace

ReliefImage shaded_relief(const Grid<double>& heights, const Box2& box) {
    const Window w = window_of(heights.shape, box);
    if (w.empty()) return {};
    const int side = (std::max(w.columns, w.rows) + kMostPixels - 1) / kMostPixels;  // cells per pixel
    const int columns = (w.columns + side - 1) / side, rows = (w.rows + side - 1) / side;
    std::vector<std::uint8_t> grey, alpha;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            int sum = 0, count = 0;
            for (int dj = 0; dj < side; ++dj) {
                for (int di = 0; di < side; ++di) {
                    const int i = w.column + column * side + di, j = w.row + w.rows - 1 - row * side - dj;
                    if (i >= w.column + w.columns || j < w.row || std::isnan(heights.at(i, j))) continue;
                    sum += shade(heights, i, j);
                    ++count;
                }
            }
            grey.push_back(static_cast<std::uint8_t>(count > 0 ? sum / count : 255));
            alpha.push_back(count > 0 ? 255 : 0);
        }
    }
    const double cell = heights.shape.cell;
    const Vec2 corner = heights.shape.origin + cell * Vec2(w.column, w.row + w.rows);  // north-west
    return {png_uri(grey, alpha, columns, rows),
            {corner - Vec2(0.0, cell * side * rows), corner + Vec2(cell * side * columns, 0.0)}};
}

std::vector<Contour> contours(const Grid<double>& heights, const Box2& box, double interval, double base) {
    const Window w = window_of(heights.shape, box);
    if (w.empty()) return {};
    const OutputScope scope;
    std::vector<Contour> lines;
    const Vec2 corner = heights.shape.origin + heights.shape.cell * Vec2(w.column, w.row + w.rows);
    ContourSink sink{&lines, corner, heights.shape.cell};
    const GDALContourGeneratorH generator =
        GDAL_CG_Create(w.columns, w.rows, TRUE, kContourNoData, interval, base, take_contour, &sink);
    std::vector<double> row(static_cast<std::size_t>(w.columns));
    bool fed = generator != nullptr;
    for (int j = w.row + w.rows - 1; fed && j >= w.row; --j) {
        for (int i = 0; i < w.columns; ++i) {
            const double z = heights.at(w.column + i, j);
            row[static_cast<std::size_t>(i)] = std::isnan(z) ? kContourNoData : z;
        }
        fed = GDAL_CG_FeedLine(generator, row.data()) == CE_None;
    }
    if (generator) GDAL_CG_Destroy(generator);
    if (!fed) scope.fail("contours", "they could not be drawn");
    return lines;
}

}  // namespace scree::gis
