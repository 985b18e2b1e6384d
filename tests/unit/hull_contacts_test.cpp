// SPDX-License-Identifier: GPL-3.0-or-later
#include "dynamics/hull_contacts.hpp"

#include "scree/base/random.hpp"
#include "scree/base/units.hpp"
#include "scree/dynamics/trajectory.hpp"
#include "support/rounding.hpp"
#include "support/scenes.hpp"
#include "support/terrains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace scree::test {

namespace {

constexpr double kConeSlack = 6e-3;  ///< 2e-3 along the way to a corner of the facet, more across the crest [rad]

/// An octahedron with its lowest vertex at (0, 0, -0.3).
FramedBlock diamond() {
    return {{{0.5, 0, 0}, {-0.5, 0, 0}, {0, 0.4, 0}, {0, -0.4, 0}, {0, 0, 0.3}, {0, 0, -0.3}}, 100.0};
}
FramedBlock box() {
    return {box_points({0.6, 0.5, 0.4}), 100.0};
}

/// Contacts of a block whose axes of points are turned by `orientation`.
std::vector<Contact<3>> contacts_of(const FramedBlock& body, const Surface& surface, const Vec3& position,
                                    const Quat& orientation, double reach) {
    HullContacts finder(body.block, surface, false);
    std::vector<Contact<3>> contacts;
    finder.detect(position, (orientation * body.to_body.conjugate()).toRotationMatrix(), reach, contacts);
    return contacts;
}

std::unique_ptr<Surface> ridge() {
    return grid_terrain(4.0, 1.0, [](double x, double) { return -0.5 * std::abs(x); });
}
std::unique_ptr<Surface> valley() {
    return grid_terrain(4.0, 1.0, [](double x, double) { return 0.5 * std::abs(x); });
}

Quat turned_about(const Vec3& axis, double degrees) {
    return Quat(Eigen::AngleAxisd(degrees * kDegree, axis));
}

}  // namespace

TEST(HullContacts, VertexOverAFacet) {
    const double slope = 30 * kDegree;
    const auto surface = inclined_plane(slope, 4.0);
    const Vec3 position(0.3, 0.2, 0.5), normal(std::sin(slope), 0.0, std::cos(slope));
    const auto contacts = contacts_of(diamond(), *surface, position, Quat::Identity(), 0.325);
    ASSERT_EQ(contacts.size(), 1u);
    const Contact<3>& c = contacts.front();
    EXPECT_EQ(c.key.pair, FeaturePair::VertexOnFacet);
    EXPECT_EQ(c.key.terrain, surface->facet_at(Vec2(0.3, 0.2)));
    EXPECT_NEAR((c.arm - Vec3(0, 0, -0.3)).norm(), 0.0, kRounding);
    EXPECT_NEAR((c.normal - normal).norm(), 0.0, kRounding);
    EXPECT_NEAR(c.gap, normal.dot(position + c.arm), kRounding);
    EXPECT_TRUE(contacts_of(diamond(), *surface, position, Quat::Identity(), 0.9 * c.gap).empty());
}

TEST(HullContacts, VertexInAValleyTouchesBothSides) {
    const auto surface = valley();
    const auto contacts = contacts_of(diamond(), *surface, {0.0, 0.4, 0.3}, Quat::Identity(), 1e-3);
    ASSERT_EQ(contacts.size(), 2u);
    EXPECT_NEAR(contacts[0].normal.x() + contacts[1].normal.x(), 0.0, kRounding);
    EXPECT_GT(std::abs(contacts[0].normal.x()), 0.4);
    // beside the valley line only the near side
    EXPECT_EQ(contacts_of(diamond(), *surface, {0.3, 0.4, 0.3 + 0.15}, Quat::Identity(), 1e-3).size(), 1u);
}

TEST(HullContacts, SeamsOfAPlaneMakeNoSecondContact) {
    for (const double slope : {0.0, 30.0}) {
        for (const Cut cut : {Cut::Grid, Cut::OtherDiagonal, Cut::Alternating, Cut::Random}) {
            const auto surface = make_mesh_surface(
                cut_mesh(4.0, 1.0, cut, [=](double x, double) { return -std::tan(slope * kDegree) * x; }));
            TerrainPatch patch;
            surface->gather(surface->bounds().grown(-2.5), patch);
            EXPECT_TRUE(patch.edges.empty());
            EXPECT_TRUE(patch.nodes.empty());
            // exactly over a node, over a side, over a diagonal
            for (const Vec2& plan : {Vec2(0, 0), Vec2(0.5, 0), Vec2(0, 0.5), Vec2(0.5, 0.5), Vec2(1e-4, 2e-4)}) {
                const Vec3 position(plan.x(), plan.y(), 0.3 - std::tan(slope * kDegree) * plan.x());
                EXPECT_EQ(contacts_of(diamond(), *surface, position, Quat::Identity(), 1e-3).size(), 1u)
                    << plan.transpose();
            }
        }
    }
}

TEST(HullContacts, TipPokesIntoAFace) {
    const auto surface =
        grid_terrain(4.0, 1.0, [](double x, double y) { return -0.5 * std::max(std::abs(x), std::abs(y)); });
    for (const double gap : {0.05, -0.03}) {
        const Vec3 position(0.1, 0.05, 0.2 + gap);
        const auto contacts = contacts_of(box(), *surface, position, Quat::Identity(), 0.08);
        ASSERT_EQ(contacts.size(), 1u);
        EXPECT_EQ(contacts[0].key.pair, FeaturePair::NodeInFace);
        EXPECT_NEAR(contacts[0].gap, gap, kRounding);
        EXPECT_NEAR((contacts[0].normal - Vec3::UnitZ()).norm(), 0.0, kRounding);
        EXPECT_NEAR((contacts[0].arm + position).norm(), 0.0, kRounding);
    }
}

TEST(HullContacts, BlockEdgeAcrossARidge) {
    const auto surface = ridge();
    const double half_diagonal = 0.5 * std::hypot(0.5, 0.4);
    const Quat on_edge = turned_about(Vec3::UnitX(), std::atan2(0.5, 0.4) / kDegree);  // lowest edge along x
    const auto contacts = contacts_of(box(), *surface, {0.05, 0.4, half_diagonal - 0.01}, on_edge, 1e-3);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_EQ(contacts[0].key.pair, FeaturePair::EdgeOnEdge);
    EXPECT_NEAR(contacts[0].gap, -0.01, 1e-9);
    EXPECT_NEAR((contacts[0].normal - Vec3::UnitZ()).norm(), 0.0, 1e-9);
    const Vec3 crest_point(-0.05, 0.0, -half_diagonal + 0.01);
    EXPECT_NEAR((contacts[0].arm - crest_point).norm(), 0.0,
                0.005);  // along the crest it may lie off by a part of the overlap
}

TEST(HullContacts, FaceFlatOnARidgeTouchesAtBothEnds) {
    const auto surface = ridge();
    const double overlap = 1e-3;  // the ends are found where the crest leaves the block: off by as much along the crest
    auto ends = [&](double y) {
        const auto contacts = contacts_of(box(), *surface, {0.05, y, 0.2 - overlap}, Quat::Identity(), 1e-3);
        std::vector<double> along;
        for (const auto& c : contacts) {
            EXPECT_EQ(c.key.pair, FeaturePair::EdgeOnEdge);
            EXPECT_NEAR(c.gap, -overlap, 1e-9);
            EXPECT_NEAR((c.normal - Vec3::UnitZ()).norm(), 0.0, 1e-9);
            along.push_back(c.arm.y());
        }
        std::sort(along.begin(), along.end());
        return along;
    };
    // between two nodes of the ridge, and across its node (0, 1), where the two ends lie on different terrain edges
    for (const double y : {0.5, 1.0}) {
        const auto along = ends(y);
        ASSERT_EQ(along.size(), 2u) << "at " << y;
        EXPECT_NEAR(along[0], -0.25, 1.01 * overlap);
        EXPECT_NEAR(along[1], 0.25, 1.01 * overlap);
    }
}

TEST(HullContacts, NothingOverAHole) {
    const auto surface = grid_terrain(4.0, 1.0, [](double x, double y) { return x == 0.0 && y == 0.0 ? kNaN : 0.0; });
    const FramedBlock body = diamond();
    EXPECT_TRUE(contacts_of(body, *surface, {0.1, 0.1, 0.3}, Quat::Identity(), 1e-2).empty());
    EXPECT_EQ(contacts_of(body, *surface, {1.6, 0.1, 0.3}, Quat::Identity(), 1e-2).size(), 1u);
    HullContacts finder(body.block, *surface, false);
    EXPECT_FALSE(finder.over_terrain({0.1, 0.1, 5.0}));
    EXPECT_TRUE(finder.over_terrain({1.6, 0.1, 5.0}));
    EXPECT_FALSE(finder.over_terrain({5.0, 0.1, 5.0}));
}

// A vertex that hangs beside the terrain below its level would meet the ground from the side.
TEST(HullContacts, AVertexBesideTheTerrainIsBeyondTheRim) {
    const auto surface = grid_terrain(4.0, 1.0, [](double, double) { return 0.0; });
    const FramedBlock body = diamond();
    HullContacts finder(body.block, *surface, false);
    std::vector<Contact<3>> contacts;
    const Mat3 rotation = body.to_body.conjugate().toRotationMatrix();
    for (const auto& [x, z, beyond] :
         {std::tuple(3.8, 0.05, false), std::tuple(3.8, -0.05, true), std::tuple(3.2, -0.05, false)}) {
        finder.detect({x, 0.1, z}, rotation, 1e-3, contacts);
        EXPECT_EQ(finder.beyond_rim(), beyond) << x << " " << z;
    }
}

// The ground that ends still holds what lies over its rim: a crest of it in a face, and the node that a ridge ends in.
TEST(HullContacts, ABlockOverARimTouchesIt) {
    for (const double across : {0.0, 0.5}) {
        const auto surface =
            grid_terrain(4.0, 1.0, [&](double x, double y) { return x > 0.0 ? kNaN : 0.5 * x - across * std::abs(y); });
        const auto contacts = contacts_of(box(), *surface, {0.1, 0.05, 0.2 - 0.01}, Quat::Identity(), 1e-3);
        ASSERT_EQ(contacts.size(), across == 0.0 ? 2u : 1u);
        for (const Contact<3>& c : contacts) {
            EXPECT_EQ(c.key.pair, across == 0.0 ? FeaturePair::EdgeOnEdge : FeaturePair::NodeInFace);
            EXPECT_NEAR(c.gap, -0.01, kRounding);
            EXPECT_NEAR((c.normal - Vec3::UnitZ()).norm(), 0.0, kRounding);
            EXPECT_NEAR(c.arm.x(), -0.1, kRounding);  // on the rim
        }
    }
}

// A crest 0.15 m in the lower face; found from above to a tenth of the gap, or to a nanometre.
TEST(HullContacts, ABlockIsLiftedUntilItIsFree) {
    const FramedBlock body = box();
    const auto surface = ridge();
    BlockState<3> state;
    state.orientation = body.to_body.conjugate();
    state.position.z() = 0.05;
    EXPECT_NEAR(clearing_lift(body.block, state, *surface, 0.0), 0.15, 1e-8);
    const double lift = clearing_lift(body.block, state, *surface, 0.02);
    EXPECT_GE(lift, 0.17 - kRounding);
    EXPECT_LE(lift, 0.172);
    state.position.z() = 0.25;
    EXPECT_EQ(clearing_lift(body.block, state, *surface, 0.02), 0.0);
}

// What no contact could hold must not go on below the ground unseen.
TEST(HullContacts, ABlockThatWentThroughTheGroundIsBuried) {
    const auto surface = grid_terrain(4.0, 1.0, [](double x, double) { return 0.5 * x; });
    const FramedBlock body = diamond();
    HullContacts finder(body.block, *surface, false);
    std::vector<Contact<3>> contacts;
    const double slope = std::sqrt(1.25), thick = body.block.inner_radius;
    for (const double depth : {-1.0, 0.0, 0.9 * thick, 1.1 * thick, 3.0}) {
        const Vec3 centre(0.4, 0.1, 0.2 - slope * depth);
        finder.detect(centre, Mat3::Identity(), 1e-3, contacts);
        EXPECT_EQ(finder.buried(centre), depth > thick) << depth;
    }
}

namespace {

/// Random blocks in random poses close to a rough slope.
template <class Check>
void for_random_poses(const Surface& surface, int count, Check&& check) {
    RandomStream random(3, 1, RandomPurpose::Shape);
    for (int k = 0; k < count; ++k) {
        ShapeSettings shape;
        shape.shape = k % 3 == 0 ? BlockShape::Sharp : (k % 3 == 1 ? BlockShape::Box : BlockShape::Hull);
        const ConvexBlock block = make_block(shape, {0.9, 0.7, 0.5}, 500.0, random);
        Quat q(random.normal(), random.normal(), random.normal(), random.normal());
        q.normalize();
        const double x = random.uniform(-3.0, 3.0), y = random.uniform(-3.0, 3.0), z = random.uniform(0.15, 0.45);
        check(block, Vec3(x, y, surface.height(Vec2(x, y)) + z), q);
    }
}

}  // namespace

// The normal of a crest contact is perpendicular to the crest and lies between the normals of its two facets; that of a tip contact has the terrain
// fall away on all sides.
TEST(HullContacts, NormalsLieInTheDihedralCone) {
    const auto surface = grid_terrain(6.0, 0.5, rough_slope(30 * kDegree, 0.25));
    TerrainPatch all;
    surface->gather(surface->bounds(), all);
    std::map<std::int64_t, const PatchEdge*> edges;
    for (const auto& e : all.edges) edges[e.id] = &e;
    std::map<std::int64_t, const PatchNode*> nodes;
    for (const auto& n : all.nodes) nodes[n.id] = &n;
    int crest_contacts = 0, tip_contacts = 0;
    std::vector<Contact<3>> contacts;
    for_random_poses(*surface, 2000, [&](const ConvexBlock& block, const Vec3& position, const Quat& q) {
        HullContacts finder(block, *surface, false);
        finder.detect(position, q.toRotationMatrix(), 1e-2, contacts);
        for (const auto& c : contacts) {
            EXPECT_NEAR(c.normal.norm(), 1.0, kRounding);
            if (c.key.pair == FeaturePair::EdgeOnEdge) {
                ++crest_contacts;
                const PatchEdge& e = *edges.at(c.key.terrain);
                const Vec3 along = (e.b - e.a).normalized();
                EXPECT_NEAR(c.normal.dot(along), 0.0, 1e-9);
                const double opening = std::acos(std::min(
                    1.0, e.normal(1).dot(e.normal(0))));  // between the facets' normals, with the finder's slack
                EXPECT_LE(std::acos(std::min(1.0, c.normal.dot(e.normal(0)))), opening + kConeSlack);
                EXPECT_LE(std::acos(std::min(1.0, c.normal.dot(e.normal(1)))), opening + kConeSlack);
                const Vec3 from_a = position + c.arm - e.a;  // the contact point lies on the crest
                EXPECT_NEAR((from_a - from_a.dot(along) * along).norm(), 0.0, 1e-9);
            } else if (c.key.pair == FeaturePair::NodeInFace) {
                ++tip_contacts;
                const PatchNode& n = *nodes.at(c.key.terrain);
                for (int s = n.first; s < n.first + n.count; ++s)
                    EXPECT_LT(c.normal.dot(all.spokes[static_cast<std::size_t>(s)].edge), 0.0);
            }
        }
    });
    RecordProperty("crest_contacts", crest_contacts);
    RecordProperty("tip_contacts", tip_contacts);
    EXPECT_GT(crest_contacts, 100);
    EXPECT_GT(tip_contacts, 5);
}

// Detection is not blind: wherever a block vertex is below the surface or a point of a crest is inside the block, there is a contact
// with a negative gap. Crests are sampled, the sampling is fine enough for overlaps of a millimetre.
TEST(HullContacts, EveryOverlapHasAContact) {
    const auto surface = grid_terrain(6.0, 0.5, rough_slope(30 * kDegree, 0.1));
    TerrainPatch all;
    surface->gather(surface->bounds(), all);
    int overlaps = 0, missed = 0;
    std::vector<Contact<3>> contacts;
    for_random_poses(*surface, 1500, [&](const ConvexBlock& block, const Vec3& position, const Quat& q) {
        double depth = 0.0;
        for (Eigen::Index i = 0; i < block.vertex_count(); ++i) {
            const Vec3 p = position + q * block.vertex(i);
            depth = std::max(depth, surface->height(p.head<2>()) - p.z());
        }
        for (const auto& e : all.edges) {
            if ((e.a - position).norm() > 2.0) continue;
            for (int s = 0; s <= 100; ++s) {
                const Vec3 p = q.conjugate() * (e.a + s / 100.0 * (e.b - e.a) - position);
                double outside = -kInfinity;
                for (Eigen::Index f = 0; f < block.face_count(); ++f)
                    outside = std::max(outside, block.normal(f).dot(p) - block.offset[f]);
                depth = std::max(depth, -outside);
            }
        }
        if (depth < 1e-3 || depth > 0.1) return;
        ++overlaps;
        HullContacts finder(block, *surface, false);
        finder.detect(position, q.toRotationMatrix(), 0.0, contacts);
        if (contacts.empty()) ++missed;
    });
    RecordProperty("overlaps", overlaps);
    RecordProperty("missed", missed);
    EXPECT_GT(overlaps, 300);
    EXPECT_EQ(missed, 0);
}

// A corner that has slipped over a crest may hook under it, where the nearest faces would push it deeper in: no crest is deep in a block without a
// contact of that depth.
TEST(HullContacts, NoCrestIsDeepInABlockUnheld) {
    const auto surface = grid_terrain(6.0, 0.5, rough_slope(30 * kDegree, 0.3));
    RandomStream random(6, 1, RandomPurpose::Shape);
    int cut = 0, hooked = 0;
    std::vector<Contact<3>> contacts;
    for_random_poses(*surface, 20000, [&](const ConvexBlock& block, const Vec3& position, const Quat& q) {
        BlockState<3> s;
        s.position = position - Vec3(0.0, 0.0, 0.2);
        s.orientation = q;
        s.position.z() += clearing_lift(block, s, *surface, 1e-4);
        s.position += 5e-3 * Vec3(random.normal(), random.normal(), random.normal());
        HullContacts finder(block, *surface, false);
        finder.detect(s.position, q.toRotationMatrix(), 0.0, contacts);
        double deepest = 0.0;
        for (const Contact<3>& c : contacts) deepest = std::max(deepest, -c.gap);
        if (finder.cut() < 1e-3) return;
        ++cut;
        if (deepest < 0.5 * finder.cut()) ++hooked;
    });
    EXPECT_GT(cut, 1000);
    EXPECT_EQ(hooked, 0);
}

// The edge of a blade has got through a sharp crest: all its corners are in the open, and so is the crest, above the blade.
TEST(HullContacts, ACrestThatWentThroughABladeIsSeen) {
    const auto surface = grid_terrain(4.0, 1.0, [](double x, double) { return -6.0 * std::abs(x); });
    const FramedBlock blade({{-0.3, -0.25, 0.0},
                             {-0.3, 0.25, 0.0},
                             {0.3, -0.25, 0.15},
                             {0.3, 0.25, 0.15},
                             {0.3, -0.25, -0.15},
                             {0.3, 0.25, -0.15}},
                            100.0);
    const auto at_edge = [&](double x) {  // its centre of mass is 0.4 m from its edge
        return contacts_of(blade, *surface, {x + 0.4, 0.1, -0.04}, Quat::Identity(), 0.0);
    };
    EXPECT_TRUE(at_edge(0.01).empty());
    const auto contacts = at_edge(-0.03);
    ASSERT_FALSE(contacts.empty());
    for (const Contact<3>& c : contacts) {
        EXPECT_EQ(c.key.pair, FeaturePair::EdgeOnEdge);
        EXPECT_GE(c.normal.x(), 0.0);
        EXPECT_GE(c.normal.z(), 1.0 / std::sqrt(37.0) - kRounding);  // between the normals of the flanks
        const Vec3 out = Vec3(0.37, 0.1, -0.04) - 1.001 * c.gap * c.normal;
        EXPECT_TRUE(contacts_of(blade, *surface, out, Quat::Identity(), 0.0).empty());
    }
}

// The tip of a block leans on a wall below its sharp crest. The crest has not got through the block, though ways along the wall meet the tip: the
// slope behind the crest is such that some of the directions that are looked into are along it.
TEST(HullContacts, ABlockThatLeansOnAWallIsNotThroughItsCrest) {
    const Vec3 wall = Vec3(6.0, 0.0, 1.0).normalized();
    for (int k = 0; k < 40; ++k) {
        const double behind = 0.2 + 0.025 * k;
        const auto surface = grid_terrain(4.0, 1.0, [&](double x, double) { return x < 0.0 ? behind * x : -6.0 * x; });
        for (const double below : {0.01, 0.03, 0.1}) {
            for (const double overlap : {1e-5, 1e-4, 3e-4}) {
                const Vec3 tip = Vec3(below / 6.0, 0.1, -below) - overlap * wall;
                const auto contacts =
                    contacts_of(diamond(), *surface, tip + Vec3(0.5, 0.0, 0.0), Quat::Identity(), 0.0);
                ASSERT_EQ(contacts.size(), 1u) << behind << ", " << below << " m, " << overlap << " m";
                EXPECT_EQ(contacts.front().key.pair, FeaturePair::VertexOnFacet);
                EXPECT_NEAR(contacts.front().gap, -overlap, kRounding);
            }
        }
    }
}

// What does not overlap is not held back: blocks a few millimetres from sharp crests. Edges of the block and crests are sampled.
TEST(HullContacts, SharpCrestsHoldNothingThatTheyDoNotTouch) {
    const auto surface = grid_terrain(6.0, 0.5, rough_slope(30 * kDegree, 0.8));
    TerrainPatch all;
    surface->gather(surface->bounds(), all);
    RandomStream random(7, 1, RandomPurpose::Shape);
    int free = 0, sharp = 0;
    std::vector<Contact<3>> contacts;
    for_random_poses(*surface, 3000, [&](const ConvexBlock& block, const Vec3& position, const Quat& q) {
        BlockState<3> s;
        s.position = position;
        s.orientation = q;
        s.position.z() += clearing_lift(block, s, *surface, 1e-4);
        s.position += 1e-2 * Vec3(random.normal(), random.normal(), random.normal());
        for (const auto& corners : block.facets) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 a = s.position + q * block.vertex(corners[k]),
                           b = s.position + q * block.vertex(corners[(k + 1) % 3]);
                for (int i = 0; i <= 200; ++i) {
                    const Vec3 p = a + i / 200.0 * (b - a);
                    if (p.z() < surface->height(p.head<2>())) return;
                }
            }
        }
        for (const auto& e : all.edges) {
            if ((e.a - s.position).norm() > 3.0) continue;
            for (int i = 0; i <= 200; ++i) {
                const Vec3 p = q.conjugate() * (e.a + i / 200.0 * (e.b - e.a) - s.position);
                if ((block.nx * p.x() + block.ny * p.y() + block.nz * p.z() - block.offset).maxCoeff() < 0.0) return;
            }
            sharp += e.normal(0).dot(e.normal(1)) < 0.5;
        }
        ++free;
        HullContacts finder(block, *surface, false);
        finder.detect(s.position, q.toRotationMatrix(), 0.0, contacts);
        for (const Contact<3>& c : contacts) EXPECT_GT(c.gap, -2e-3);
    });
    EXPECT_GT(free, 500);
    EXPECT_GT(sharp, 10 * free);
}

// A finder that has been elsewhere gives the same contacts in the same order as a fresh one.
TEST(HullContacts, DependOnThePoseOnly) {
    const auto surface = grid_terrain(6.0, 0.5, rough_slope(30 * kDegree, 0.1));
    for_random_poses(*surface, 200, [&](const ConvexBlock& block, const Vec3& position, const Quat& q) {
        HullContacts fresh(block, *surface, false), travelled(block, *surface, false);
        std::vector<Contact<3>> a, b;
        for (const double shift : {0.5, 0.3, 0.1})
            travelled.detect(position + Vec3(shift, -shift, 0.0), q.toRotationMatrix(), 0.3, b);
        fresh.detect(position, q.toRotationMatrix(), 0.02, a);
        travelled.detect(position, q.toRotationMatrix(), 0.02, b);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t k = 0; k < a.size(); ++k) {
            EXPECT_TRUE(a[k].key == b[k].key);
            EXPECT_EQ(a[k].gap, b[k].gap);
            EXPECT_EQ(a[k].normal, b[k].normal);
        }
    });
}

// The block flies as long as free_time says and meets nothing; and it gets on: near contact the time shrinks with the gap only.
TEST(HullContacts, NothingTouchesWithinTheFreeTime) {
    const auto surface = grid_terrain(8.0, 0.5, rough_slope(30 * kDegree, 0.1));
    RandomStream random(5, 1, RandomPurpose::Shape);
    std::vector<Contact<3>> contacts;
    double deepest = 0.0;
    int near = 0, number = 0;
    for_random_poses(*surface, 1200, [&](const ConvexBlock& block, const Vec3& position, const Quat& q) {
        BlockState<3> s;
        s.position = position + Vec3(0.0, 0.0, random.uniform(0.05, 0.5));
        s.orientation = q;
        s.velocity = {random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-8, 2)};
        s.spin = {random.uniform(-15, 15), random.uniform(-15, 15), random.uniform(-15, 15)};
        HullContacts finder(block, *surface, false);
        const double spin_bound = std::sqrt(s.spin.cwiseProduct(block.inertia).dot(s.spin) / block.inertia.minCoeff());
        double gap = 0.0;
        // every third block under drag, as long as it is constant in the engine
        const double rate = ++number % 3 == 0 ? random.uniform(0.1, 8.0) : 0.0;
        const Vec3 drag = -rate * s.velocity;
        const double time =
            std::min(finder.free_time(s, spin_bound, kStandardGravity, drag, gap), rate > 0.0 ? 0.2 / rate : kInfinity);
        if (gap < 0.01) return;  // overlaps, or as good as touches
        EXPECT_GT(time, 0.0);
        if (std::isfinite(gap)) ++near;
        for (int k = 1; k <= 8; ++k) {
            BlockState<3> later = s;
            const double t = time * k / 8;
            later.position += t * s.velocity - 0.5 * kStandardGravity * t * t * Vec3::UnitZ() + 0.5 * t * t * drag;
            rotate_freely(block.inertia, 1e-3, t, later.orientation, later.spin);
            finder.detect(later.position, later.orientation.toRotationMatrix(), 0.0, contacts);
            for (const auto& c : contacts) deepest = std::max(deepest, -c.gap);
        }
    });
    EXPECT_GT(near, 50);
    EXPECT_LT(deepest, 1e-9);
}

TEST(HullContacts, ClearanceIsALowerBoundOfEveryGap) {
    const auto surface = grid_terrain(6.0, 0.5, rough_slope(30 * kDegree, 0.1));
    std::vector<Contact<3>> contacts;
    for_random_poses(*surface, 300, [&](const ConvexBlock& block, const Vec3& position, const Quat& q) {
        HullContacts finder(block, *surface, false);
        const double clearance = finder.clearance(position, q.toRotationMatrix());
        finder.detect(position, q.toRotationMatrix(), 0.5, contacts);
        for (const auto& c : contacts) EXPECT_LE(clearance, c.gap + 1e-9);
    });
}

// The same triangles as a grid and as a mesh: same facets, crests and tips, and the same contacts up to the numbers of crests and tips.
TEST(HullContacts, GridAndMeshAgree) {
    const auto grid = grid_terrain(6.0, 0.5, rough_slope(30 * kDegree, 0.1));
    const auto mesh = make_mesh_surface(mesh_of(*grid));
    TerrainPatch a, b;
    grid->gather({{-2, -2}, {2, 2}}, a);
    mesh->gather({{-2, -2}, {2, 2}}, b);
    std::map<std::int64_t, const PatchFacet*> facets;
    for (const auto& f : b.facets) facets[f.id] = &f;
    for (const auto& f : a.facets) {
        ASSERT_TRUE(facets.contains(f.id));
        EXPECT_NEAR((f.normal - facets[f.id]->normal).norm() + std::abs(f.offset - facets[f.id]->offset), 0.0,
                    kRounding);
    }
    auto inside = [](const Vec3& p) { return p.head<2>().cwiseAbs().maxCoeff() < 1.9; };
    auto edge_places = [&](const TerrainPatch& patch) {
        std::vector<std::array<double, 2>> places;
        for (const auto& e : patch.edges)
            if (inside(e.a) && inside(e.b)) places.push_back({e.a.x() + e.b.x(), e.a.y() + e.b.y()});
        std::sort(places.begin(), places.end());
        return places;
    };
    auto node_places = [&](const TerrainPatch& patch) {
        std::vector<std::array<double, 2>> places;
        for (const auto& n : patch.nodes)
            if (inside(n.position)) places.push_back({n.position.x(), n.position.y()});
        std::sort(places.begin(), places.end());
        return places;
    };
    EXPECT_EQ(edge_places(a), edge_places(b));
    EXPECT_EQ(node_places(a), node_places(b));
    EXPECT_GT(node_places(a).size(), 5u);

    for_random_poses(*grid, 500, [&](const ConvexBlock& block, const Vec3& position, const Quat& q) {
        HullContacts on_grid(block, *grid, false), on_mesh(block, *mesh, false);
        std::vector<Contact<3>> x, y;
        on_grid.detect(position, q.toRotationMatrix(), 0.02, x);
        on_mesh.detect(position, q.toRotationMatrix(), 0.02, y);
        ASSERT_EQ(x.size(), y.size());
        auto by_place = [](const Contact<3>& l, const Contact<3>& r) {
            return std::tuple(l.key.pair, l.arm.x(), l.gap) < std::tuple(r.key.pair, r.arm.x(), r.gap);
        };
        std::sort(x.begin(), x.end(), by_place);
        std::sort(y.begin(), y.end(), by_place);
        for (std::size_t k = 0; k < x.size(); ++k) {
            EXPECT_EQ(x[k].key.pair, y[k].key.pair);
            EXPECT_NEAR(x[k].gap, y[k].gap, 1e-9);
            EXPECT_NEAR((x[k].normal - y[k].normal).norm() + (x[k].arm - y[k].arm).norm(), 0.0, 1e-9);
        }
    });
}

}  // namespace scree::test
