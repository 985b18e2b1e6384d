// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/patch_builder.hpp"

#include "scree/base/error.hpp"
#include "scree/geometry/surface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scree {

namespace {

/// An edge of the mesh that is a crest, or a rim: then it has one facet, on its left, and -1 for the other.
struct Crest {
    std::int32_t a, b;                   ///< vertices
    std::array<std::int32_t, 2> beyond;  ///< third vertices of the two facets
    std::array<std::int32_t, 2> facet;
};
/// In place of a neighbour in the ring around a vertex: the wall of a rim.
constexpr std::int32_t kWall = -1;

/// Area of a triangle within the box, in plan view: Sutherland-Hodgman clipping on the four sides [m^2].
double area_in_box(const std::array<Vec3, 3>& corners, const Box2& box) {
    std::array<Vec2, 8> shape, cut;
    std::size_t count = 3;
    for (std::size_t k = 0; k < 3; ++k) shape[k] = corners[k].head<2>();
    for (int side = 0; side < 4; ++side) {
        const int axis = side % 2;
        const double sign = side < 2 ? 1.0 : -1.0;
        const double limit = side < 2 ? box.max[axis] : box.min[axis];
        std::size_t kept = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const Vec2 &a = shape[k], &b = shape[(k + 1) % count];
            const double inside_a = sign * (limit - a[axis]), inside_b = sign * (limit - b[axis]);
            if (inside_a >= 0.0) cut[kept++] = a;
            if ((inside_a > 0.0 && inside_b < 0.0) || (inside_a < 0.0 && inside_b > 0.0))
                cut[kept++] = a + inside_a / (inside_a - inside_b) * (b - a);
        }
        shape = cut;
        count = kept;
        if (count < 3) return 0.0;
    }
    double twice = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        const Vec2 &a = shape[k], &b = shape[(k + 1) % count];
        twice += cross(a, b);
    }
    return 0.5 * twice;
}

class MeshSurface final : public Surface {
public:
    explicit MeshSurface(TriangleMesh mesh);

    Box2 bounds() const override { return bounds_; }
    std::int64_t facet_count() const override { return static_cast<std::int64_t>(mesh_.facets.size()); }
    bool facet(std::int64_t f, std::array<Vec3, 3>& c, SoilId& soil) const override {
        c = corners(f);
        soil = mesh_.soil[static_cast<std::size_t>(f)];
        return true;
    }
    std::int64_t facet_at(const Vec2& p) const override;
    void gather(const Box2& box, TerrainPatch& patch) const override;
    SupportingPlane supporting_plane(const Box2& box) const override { return plane_over(facets_around(box), box); }

private:
    /// Facets of all bins that the box touches, each once, by number.
    std::vector<std::int32_t> facets_around(const Box2& box) const;
    SupportingPlane plane_over(const std::vector<std::int32_t>& facets, const Box2& box) const;
    std::array<Vec3, 3> corners(std::int64_t f) const {
        const auto& t = mesh_.facets[static_cast<std::size_t>(f)];
        return {vertex(t[0]), vertex(t[1]), vertex(t[2])};
    }
    const Vec3& vertex(std::int32_t v) const { return mesh_.vertices[static_cast<std::size_t>(v)]; }
    void check_facets();
    void build_bins();
    void build_topology();
    std::array<int, 4> bin_range(const Box2& box) const;
    void gather_crests(std::vector<std::int32_t>& crests, TerrainPatch& patch) const;
    void gather_tips(std::vector<std::int32_t>& vertices, TerrainPatch& patch) const;

    TriangleMesh mesh_;
    Box2 bounds_;       ///< [m]
    double bin_ = 1.0;  ///< edge of a bin, about that of a facet [m]
    int bin_columns_ = 0;
    int bin_rows_ = 0;
    std::vector<std::int32_t> bin_start_;
    std::vector<std::int32_t> bin_facets_;
    std::vector<Crest> crests_;
    std::vector<std::array<std::int32_t, 3>> facet_crests_;  ///< crest number of each side, -1
    std::vector<std::int32_t> ring_start_;  ///< of each vertex that may be a tip: its neighbours in order
    std::vector<std::int32_t> ring_;
    std::vector<std::int32_t> ring_facet_;
};

MeshSurface::MeshSurface(TriangleMesh mesh) : mesh_(std::move(mesh)) {
    if (mesh_.facets.empty()) throw InputError("the terrain has no facets: the DTM holds no valid area");
    SCREE_ASSERT(mesh_.soil.size() == mesh_.facets.size());
    for (const Vec3& v : mesh_.vertices) bounds_.add(v.head<2>());
    check_facets();
    build_bins();
    build_topology();
}

void MeshSurface::check_facets() {
    for (std::int64_t f = 0; f < facet_count(); ++f) {
        const auto c = corners(f);
        const double twice_area = (c[1] - c[0]).cross(c[2] - c[0]).z();
        if (!(twice_area > 0.0))
            throw InputError("terrain facet " + std::to_string(f) + " near (" + std::to_string(c[0].x()) + ", " +
                             std::to_string(c[0].y()) +
                             ") has no area seen from above: the terrain must be single-valued in height");
    }
}

std::array<int, 4> MeshSurface::bin_range(const Box2& box) const {
    auto clamp = [](double value, int count) { return static_cast<int>(std::clamp(value, 0.0, double(count - 1))); };
    return {clamp(std::floor((box.min.x() - bounds_.min.x()) / bin_), bin_columns_),
            clamp(std::floor((box.min.y() - bounds_.min.y()) / bin_), bin_rows_),
            clamp(std::floor((box.max.x() - bounds_.min.x()) / bin_), bin_columns_),
            clamp(std::floor((box.max.y() - bounds_.min.y()) / bin_), bin_rows_)};
}

// Bins of about one facet's size, facets listed in every bin that their box overlaps (counting sort).
void MeshSurface::build_bins() {
    const Vec2 size = bounds_.max - bounds_.min;
    bin_ = std::max(std::sqrt(size.x() * size.y() / static_cast<double>(mesh_.facets.size()) * 2.0), 1e-6);
    bin_columns_ = static_cast<int>(std::floor(size.x() / bin_)) + 1;
    bin_rows_ = static_cast<int>(std::floor(size.y() / bin_)) + 1;
    const auto bins = static_cast<std::size_t>(bin_columns_) * static_cast<std::size_t>(bin_rows_);
    auto for_each_bin = [&](std::int64_t f, auto&& action) {
        Box2 box;
        for (const Vec3& c : corners(f)) box.add(c.head<2>());
        const auto [i0, j0, i1, j1] = bin_range(box);
        for (int j = j0; j <= j1; ++j)
            for (int i = i0; i <= i1; ++i)
                action(static_cast<std::size_t>(j) * static_cast<std::size_t>(bin_columns_) +
                       static_cast<std::size_t>(i));
    };
    bin_start_.assign(bins + 1, 0);
    for (std::int64_t f = 0; f < facet_count(); ++f) for_each_bin(f, [&](std::size_t bin) { ++bin_start_[bin + 1]; });
    for (std::size_t b = 0; b < bins; ++b) bin_start_[b + 1] += bin_start_[b];
    bin_facets_.resize(static_cast<std::size_t>(bin_start_.back()));
    std::vector<std::int32_t> next(bin_start_.begin(), bin_start_.end() - 1);
    for (std::int64_t f = 0; f < facet_count(); ++f)
        for_each_bin(f, [&](std::size_t bin) {
            bin_facets_[static_cast<std::size_t>(next[bin]++)] = static_cast<std::int32_t>(f);
        });
}

void MeshSurface::build_topology() {
    // half edges sorted by their vertex pair meet their twins
    struct HalfEdge {
        std::int32_t low, high, facet, side;
    };
    std::vector<HalfEdge> half;
    half.reserve(3 * mesh_.facets.size());
    for (std::size_t f = 0; f < mesh_.facets.size(); ++f) {
        for (std::int32_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(mesh_.facets[f][static_cast<std::size_t>(k)],
                                                 mesh_.facets[f][static_cast<std::size_t>((k + 1) % 3)]);
            half.push_back({low, high, static_cast<std::int32_t>(f), k});
        }
    }
    std::sort(half.begin(), half.end(), [](const HalfEdge& x, const HalfEdge& y) {
        return std::tie(x.low, x.high, x.facet) < std::tie(y.low, y.high, y.facet);
    });
    facet_crests_.assign(mesh_.facets.size(), {-1, -1, -1});
    std::vector<std::array<std::int32_t, 3>> across(mesh_.facets.size(), {-1, -1, -1});
    std::vector<std::int32_t> crest_count(mesh_.vertices.size(), 0);
    // of each side without a twin, the vertex that it leaves and its facet: there the facets around that vertex begin
    std::vector<std::pair<std::int32_t, std::int32_t>> rim_starts;
    for (std::size_t h = 0; h < half.size(); ++h) {
        const HalfEdge& x = half[h];
        const auto& tx = mesh_.facets[static_cast<std::size_t>(x.facet)];
        const std::int32_t a = tx[static_cast<std::size_t>(x.side)];
        const std::int32_t b = tx[static_cast<std::size_t>((x.side + 1) % 3)];
        const std::int32_t beyond_x = tx[static_cast<std::size_t>((x.side + 2) % 3)];
        std::int32_t& crest_of_x = facet_crests_[static_cast<std::size_t>(x.facet)][static_cast<std::size_t>(x.side)];
        if (h + 1 == half.size() || half[h + 1].low != x.low || half[h + 1].high != x.high) {
            rim_starts.push_back({a, x.facet});
            crest_of_x = static_cast<std::int32_t>(crests_.size());
            crests_.push_back({a, b, {beyond_x, kWall}, {x.facet, -1}});
            continue;
        }
        const HalfEdge& y = half[++h];
        const auto& ty = mesh_.facets[static_cast<std::size_t>(y.facet)];
        across[static_cast<std::size_t>(x.facet)][static_cast<std::size_t>(x.side)] = y.facet;
        across[static_cast<std::size_t>(y.facet)][static_cast<std::size_t>(y.side)] = x.facet;
        const std::int32_t beyond_y = ty[static_cast<std::size_t>((y.side + 2) % 3)];
        const Vec3 normal = (vertex(b) - vertex(a)).cross(vertex(beyond_x) - vertex(a)).normalized();
        if (!is_crest(normal, vertex(a), vertex(beyond_y))) continue;
        crest_of_x = facet_crests_[static_cast<std::size_t>(y.facet)][static_cast<std::size_t>(y.side)] =
            static_cast<std::int32_t>(crests_.size());
        crests_.push_back({a, b, {beyond_x, beyond_y}, {x.facet, y.facet}});
        ++crest_count[static_cast<std::size_t>(a)];
        ++crest_count[static_cast<std::size_t>(b)];
    }

    // ordered rings around vertices that at least three crests meet in, and around those on the rim
    std::vector<std::int32_t> some_facet(mesh_.vertices.size(), -1);
    for (std::size_t f = 0; f < mesh_.facets.size(); ++f)
        for (const std::int32_t v : mesh_.facets[f])
            some_facet[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(f);
    // the facets around v counter-clockwise from the first, each with the side that begins it; ends with a wall if they do not close
    auto add_ring = [&](std::int32_t v, std::int32_t first) {
        std::int32_t f = first;
        for (;;) {
            const auto& t = mesh_.facets[static_cast<std::size_t>(f)];
            const auto k = static_cast<std::size_t>(std::find(t.begin(), t.end(), v) - t.begin());
            ring_.push_back(t[(k + 1) % 3]);
            ring_facet_.push_back(f);
            const std::int32_t next = across[static_cast<std::size_t>(f)][(k + 2) % 3];  // over the side that ends in v
            if (next == first) return;
            if (next < 0) {
                ring_.insert(ring_.end(), {t[(k + 2) % 3], kWall});
                ring_facet_.insert(ring_facet_.end(), 2, f);
                return;
            }
            f = next;
        }
    };
    std::sort(rim_starts.begin(), rim_starts.end());
    auto start = rim_starts.begin();
    ring_start_.assign(mesh_.vertices.size() + 1, 0);
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
        ring_start_[v] = static_cast<std::int32_t>(ring_.size());
        const auto number = static_cast<std::int32_t>(v);
        if (start != rim_starts.end() && start->first == number) {
            for (; start != rim_starts.end() && start->first == number; ++start) add_ring(number, start->second);
        } else if (crest_count[v] >= 3) {
            add_ring(number, some_facet[v]);
        }
    }
    ring_start_.back() = static_cast<std::int32_t>(ring_.size());
}

std::int64_t MeshSurface::facet_at(const Vec2& p) const {
    if (!bounds_.contains(p)) return -1;
    const auto [i, j, i1, j1] = bin_range({p, p});
    const auto bin = static_cast<std::size_t>(j) * static_cast<std::size_t>(bin_columns_) + static_cast<std::size_t>(i);
    std::int64_t best = -1;
    double best_inset = -1e-9;
    for (std::int32_t k = bin_start_[bin]; k < bin_start_[bin + 1]; ++k) {
        const std::int32_t f = bin_facets_[static_cast<std::size_t>(k)];
        const double inset = make_patch_facet(corners(f), 0, f).inset(p);
        if (inset > best_inset) {
            best_inset = inset;
            best = f;
        }
    }
    return best;
}

std::vector<std::int32_t> MeshSurface::facets_around(const Box2& box) const {
    const auto [i0, j0, i1, j1] = bin_range(box);
    std::vector<std::int32_t> found;
    for (int j = j0; j <= j1; ++j) {
        const auto row = static_cast<std::size_t>(j) * static_cast<std::size_t>(bin_columns_);
        found.insert(found.end(), bin_facets_.begin() + bin_start_[row + static_cast<std::size_t>(i0)],
                     bin_facets_.begin() + bin_start_[row + static_cast<std::size_t>(i1) + 1]);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

// Whether the box is covered: the plan areas of the facets, cut to the box, add up to its own.
SupportingPlane MeshSurface::plane_over(const std::vector<std::int32_t>& facets, const Box2& box) const {
    SupportingPlane plane;
    Vec3 sum = Vec3::Zero();
    double covered = 0.0;
    for (const std::int32_t f : facets) {
        const auto c = corners(f);
        sum += (c[1] - c[0]).cross(c[2] - c[0]);
        covered += area_in_box(c, box);
    }
    const double area = (box.max.x() - box.min.x()) * (box.max.y() - box.min.y());
    plane.whole = covered >= area * (1.0 - 1e-9);
    if (sum.z() > 0.0) plane.normal = sum.normalized();
    for (const std::int32_t f : facets)
        for (const std::int32_t v : mesh_.facets[static_cast<std::size_t>(f)])
            plane.offset = std::max(plane.offset, plane.normal.dot(vertex(v)));
    return plane;
}

void MeshSurface::gather(const Box2& box, TerrainPatch& patch) const {
    patch.clear();
    patch.box = box;
    const auto [i0, j0, i1, j1] = bin_range(box);
    const std::vector<std::int32_t> found = facets_around(box);
    patch.plane = plane_over(found, box);
    std::vector<std::int32_t> crests, vertices;
    for (const std::int32_t f : found) {
        patch.add_facet(make_patch_facet(corners(f), mesh_.soil[static_cast<std::size_t>(f)], f));
        for (const std::int32_t crest : facet_crests_[static_cast<std::size_t>(f)])
            if (crest >= 0) crests.push_back(crest);
        for (const std::int32_t v : mesh_.facets[static_cast<std::size_t>(f)])
            if (ring_start_[static_cast<std::size_t>(v) + 1] > ring_start_[static_cast<std::size_t>(v)])
                vertices.push_back(v);
    }
    gather_crests(crests, patch);
    gather_tips(vertices, patch);

    // the surface's own bins, cut out
    patch.bin_size = bin_;
    patch.bin_columns = i1 - i0 + 1;
    patch.bin_rows = j1 - j0 + 1;
    patch.bin_origin = bounds_.min + bin_ * Vec2(i0, j0);
    patch.bin_start.push_back(0);
    for (int j = j0; j <= j1; ++j) {
        for (int i = i0; i <= i1; ++i) {
            const auto bin =
                static_cast<std::size_t>(j) * static_cast<std::size_t>(bin_columns_) + static_cast<std::size_t>(i);
            for (std::int32_t k = bin_start_[bin]; k < bin_start_[bin + 1]; ++k) {
                const auto place =
                    std::lower_bound(found.begin(), found.end(), bin_facets_[static_cast<std::size_t>(k)]);
                patch.bin_facets.push_back(static_cast<std::int32_t>(place - found.begin()));
            }
            patch.bin_start.push_back(static_cast<std::int32_t>(patch.bin_facets.size()));
        }
    }
}

void MeshSurface::gather_crests(std::vector<std::int32_t>& crests, TerrainPatch& patch) const {
    std::sort(crests.begin(), crests.end());
    crests.erase(std::unique(crests.begin(), crests.end()), crests.end());
    for (const std::int32_t number : crests) {
        const Crest& crest = crests_[static_cast<std::size_t>(number)];
        const SoilId soil = mesh_.soil[static_cast<std::size_t>(crest.facet[0])];
        if (crest.facet[1] < 0) {
            patch.edges.push_back(rim_edge(vertex(crest.a), vertex(crest.b), vertex(crest.beyond[0]), soil, number));
            continue;
        }
        PatchEdge e;
        e.a = vertex(crest.a);
        e.b = vertex(crest.b);
        e.beyond = {vertex(crest.beyond[0]), vertex(crest.beyond[1])};
        e.soil = {soil, mesh_.soil[static_cast<std::size_t>(crest.facet[1])]};
        e.id = number;
        patch.edges.push_back(e);
    }
}

void MeshSurface::gather_tips(std::vector<std::int32_t>& vertices, TerrainPatch& patch) const {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const std::int32_t v : vertices) {
        PatchNode n;
        n.position = vertex(v);
        n.first = static_cast<std::int32_t>(patch.spokes.size());
        n.id = v;
        for (std::int32_t k = ring_start_[static_cast<std::size_t>(v)];
             k < ring_start_[static_cast<std::size_t>(v) + 1]; ++k) {
            const std::int32_t f = ring_facet_[static_cast<std::size_t>(k)], to = ring_[static_cast<std::size_t>(k)];
            patch.spokes.push_back({to == kWall ? Vec3(-Vec3::UnitZ()) : Vec3(vertex(to) - n.position),
                                    mesh_.soil[static_cast<std::size_t>(f)]});
            ++n.count;
        }
        patch.nodes.push_back(n);
    }
}

}  // namespace

std::unique_ptr<Surface> make_mesh_surface(TriangleMesh mesh) {
    return std::make_unique<MeshSurface>(std::move(mesh));
}

}  // namespace scree
