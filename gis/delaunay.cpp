// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/delaunay.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace scree::gis {

namespace {

// index of a point; -1 while the triangulation has made it and nobody has asked yet
struct VertexInfo {
    std::int32_t index = -1;
};
// the points that the face had when it was last shown
struct FaceInfo {
    ConstrainedDelaunay::Face seen{-1, -1, -1};
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexInfo, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<FaceInfo, Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;

}  // namespace

struct ConstrainedDelaunay::State {
    Triangulation triangulation;
    std::vector<Triangulation::Vertex_handle> handles;
    std::vector<Vec2> points;
    Triangulation::Face_handle near;

    std::int32_t index_of(const Triangulation::Vertex_handle& vertex) {
        if (vertex->info().index < 0) {
            vertex->info().index = static_cast<std::int32_t>(points.size());
            handles.push_back(vertex);
            points.emplace_back(vertex->point().x(), vertex->point().y());
        }
        return vertex->info().index;
    }
    Face face_of(const Triangulation::Face_handle& face) {
        return {index_of(face->vertex(0)), index_of(face->vertex(1)), index_of(face->vertex(2))};
    }
};

ConstrainedDelaunay::ConstrainedDelaunay() : state_(std::make_unique<State>()) {}
ConstrainedDelaunay::~ConstrainedDelaunay() = default;

std::int32_t ConstrainedDelaunay::insert(const Vec2& p) {
    const Triangulation::Vertex_handle vertex = state_->triangulation.insert({p.x(), p.y()}, state_->near);
    state_->near = vertex->face();
    return state_->index_of(vertex);
}

void ConstrainedDelaunay::constrain(std::int32_t a, std::int32_t b) {
    if (a == b) return;
    state_->triangulation.insert_constraint(state_->handles[static_cast<std::size_t>(a)],
                                            state_->handles[static_cast<std::size_t>(b)]);
    state_->near = Triangulation::Face_handle();  // it may be gone
}

void ConstrainedDelaunay::for_each_new_face(const std::function<void(const Face&)>& use) {
    const Triangulation& t = state_->triangulation;
    for (auto face = t.finite_faces_begin(); face != t.finite_faces_end(); ++face) {
        const Face points = state_->face_of(face);
        if (face->info().seen == points) continue;
        Triangulation::Face_handle(face)->info().seen = points;
        use(points);
    }
}

void ConstrainedDelaunay::for_each_face(const std::function<void(const Face&)>& use) {
    const Triangulation& t = state_->triangulation;
    for (auto face = t.finite_faces_begin(); face != t.finite_faces_end(); ++face) use(state_->face_of(face));
}

const std::vector<Vec2>& ConstrainedDelaunay::points() const {
    return state_->points;
}

}  // namespace scree::gis
