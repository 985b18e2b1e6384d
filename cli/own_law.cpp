// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/own_law.hpp"

#include "scree/base/error.hpp"

#include <dlfcn.h>

namespace scree::cli {

OwnLaw load_own_law(const std::filesystem::path& library, const std::string& where) {
    const std::string file =
        std::filesystem::absolute(library).string();  // without a folder dlopen would search the system's
    void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
        const char* reason = dlerror();
        throw InputError(where + ": cannot load the library " + library.string() + ": " +
                         (reason ? reason : "unknown") + "; compile it as include/scree/own_law.h says");
    }
    OwnLaw law;
    law.library = std::shared_ptr<void>(handle, [](void* h) { dlclose(h); });
    law.contact_law = reinterpret_cast<decltype(law.contact_law)>(dlsym(handle, "scree_contact_law"));
    law.ground_drag = reinterpret_cast<decltype(law.ground_drag)>(dlsym(handle, "scree_ground_drag"));
    if (!law.contact_law && !law.ground_drag)
        throw InputError(where + ": the library " + library.string() +
                         " has neither scree_contact_law nor scree_ground_drag: give one of them C linkage, as "
                         "include/scree/own_law.h declares it");
    return law;
}

}  // namespace scree::cli
