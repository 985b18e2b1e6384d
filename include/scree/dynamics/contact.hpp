// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <cstdint>

namespace scree {

/// Which features touch. A contact keeps its key from step to step while the same features stay in touch.
enum class FeaturePair : std::uint8_t { VertexOnFacet, NodeInFace, EdgeOnEdge };

struct ContactKey {
    FeaturePair pair = FeaturePair::VertexOnFacet;
    std::int64_t block = 0;    ///< vertex of the block, or faces whose edge it is; 0 for nodes
    std::int64_t terrain = 0;  ///< facet, node or edge of the terrain

    bool operator==(const ContactKey&) const = default;
};

/// What a contact does as the block moves on.
enum class ContactMotion : std::uint8_t {
    Stays,           ///< arm and normal stay: a round body, an edge across a crest
    TurnsWithBlock,  ///< its point is a corner of the block
    PassesBlock,     ///< its point is a corner of the terrain, its normal that of a side of the block
};

/// One point where the block touches the terrain or is about to.
template <int Dim>
struct Contact {
    using Vec = Eigen::Matrix<double, Dim, 1>;
    double gap = kNaN;         ///< distance along the normal, negative when the bodies overlap [m]
    Vec normal = Vec::Zero();  ///< unit, from the terrain into the block, local frame [-]
    Vec arm = Vec::Zero();     ///< contact point minus centre of mass, local frame [m]
    SoilId soil = 0;           ///< of the facet touched
    ContactMotion motion = ContactMotion::Stays;
    ContactKey key;
};

/// True if the two are the same touching pair: the same block vertex may slide from facet to facet.
inline bool same_pair(const ContactKey& a, const ContactKey& b) {
    return a.pair == b.pair && a.block == b.block && (a.pair == FeaturePair::VertexOnFacet || a.terrain == b.terrain);
}

}  // namespace scree
