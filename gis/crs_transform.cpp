// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/crs_transform.hpp"

#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <proj.h>

#include <cmath>

namespace scree::gis {

struct CrsTransform::State {
    struct ContextDeleter {
        void operator()(PJ_CONTEXT* c) const { proj_context_destroy(c); }
    };
    struct Deleter {
        void operator()(PJ* p) const { proj_destroy(p); }
    };
    std::unique_ptr<PJ_CONTEXT, ContextDeleter> context;  // first: it must outlive what was made in it
    std::unique_ptr<PJ, Deleter> operation;
};

CrsTransform::CrsTransform(const std::string& from, const std::string& to, const std::string& place)
    : state_(std::make_unique<State>()) {
    using Object = std::unique_ptr<PJ, State::Deleter>;
    state_->context.reset(proj_context_create());
    PJ_CONTEXT* context = state_->context.get();
    proj_log_level(context, PJ_LOG_NONE);

    if (!proj_context_get_database_path(context))
        throw InputError(
            words(place,
                  " cannot be transformed: PROJ does not find its database proj.db; PROJ_DATA or PROJ_LIB, if "
                  "set, must lead to that of the PROJ that is used here."));
    const Object source(proj_create(context, from.c_str())), target(proj_create(context, to.c_str()));
    const char* const options[] = {"ALLOW_BALLPARK=NO", nullptr};
    if (source && target) {
        const Object raw(proj_create_crs_to_crs_from_pj(context, source.get(), target.get(), nullptr, options));
        if (raw) state_->operation.reset(proj_normalize_for_visualization(context, raw.get()));
    }
    if (!state_->operation) {
        throw InputError(words(place,
                               " cannot be transformed to the terrain's CRS: PROJ knows no transformation of stated "
                               "accuracy between them; reproject the file, for example in QGIS, with the grid files "
                               "that it offers; a local CRS of a survey or a building has none, and must be "
                               "georeferenced first."));
    }
}

CrsTransform::~CrsTransform() = default;
CrsTransform::CrsTransform(CrsTransform&&) noexcept = default;
CrsTransform& CrsTransform::operator=(CrsTransform&&) noexcept = default;

std::optional<Vec2> CrsTransform::operator()(const Vec2& p) {
    proj_errno_reset(state_->operation.get());
    const PJ_COORD result = proj_trans(state_->operation.get(), PJ_FWD, proj_coord(p.x(), p.y(), 0, HUGE_VAL));
    if (!std::isfinite(result.xy.x) || !std::isfinite(result.xy.y)) return std::nullopt;
    return Vec2{result.xy.x, result.xy.y};
}

CrsTransform::Operation CrsTransform::last_operation() const {
    const std::unique_ptr<PJ, State::Deleter> used(proj_trans_get_last_used_operation(state_->operation.get()));
    if (!used) return {};
    const PJ_PROJ_INFO info = proj_pj_info(used.get());
    std::string name = info.description ? info.description : "";
    for (const std::string noise : {"axis order change (2D) + ", " + axis order change (2D)"}) {
        for (std::size_t at = name.find(noise); at != std::string::npos; at = name.find(noise))
            name.erase(at, noise.size());
    }
    const double accuracy = proj_coordoperation_get_accuracy(state_->context.get(), used.get());
    return {name, accuracy >= 0 ? accuracy : kNaN};
}

}  // namespace scree::gis
