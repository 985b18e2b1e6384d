# Do the checks see what they are for? Plants one violation after the other into a small tree and expects each to be reported.
# Usage: cmake -DHERE=folder of the checks -DWORK=scratch folder -P check_plants.cmake
set(folder "me/someone")  # put together here, or check_paths would report this file
set(good_header [[
#include <vector>
#include <Eigen/Core>
#include "scree/base/error.hpp"
struct S {
    struct Ends {
        double from, to;  ///< of a stretch [m]
    };
    double mass = 1.0;  ///< of the body [kg]
    /// Of each block; of all of them [m/s].
    std::vector<std::vector<double>>
        speeds;
    double volume() const { return mass / 2700.0; }
};
inline double half(double x) {
    const double factor = 0.5;
    return factor * x;
}
]])
function(expect_report check file line)
  file(REMOVE_RECURSE ${WORK})
  file(WRITE ${WORK}/include/scree/base/good.hpp "${good_header}")
  file(WRITE ${WORK}/gis/good.cpp "#include \"scree/geometry/grid.hpp\"\n#include <gdal_priv.h>\n")
  file(WRITE ${WORK}/gis/README.md "`good` is a file, bad is none.\n")
  file(WRITE ${WORK}/cli/cmd_good.cpp "#include \"scree/dynamics/soil.hpp\"\n#include \"gis/layers.hpp\"\n")
  file(WRITE ${WORK}/cli/README.md "| `cmd_*` | one command each |\n")
  file(WRITE ${WORK}/my-build/CMakeCache.txt "")
  file(WRITE ${WORK}/my-build/generated/made.cmake "include(/ho${folder}/scree.cmake)\n")
  file(WRITE ${WORK}/tests/CMakeLists.txt "scree_test(test_unit SOURCES unit/good_test.cpp)\n")
  file(WRITE ${WORK}/tests/unit/good_test.cpp "#include <gtest/gtest.h>\n")
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${WORK} -P ${HERE}/check_${check}.cmake RESULT_VARIABLE clean ERROR_VARIABLE said)
  if(NOT clean EQUAL 0)
    message(SEND_ERROR "check_${check} objects to a clean tree: ${said}")
  endif()
  file(APPEND ${WORK}/${file} "${line}\n")
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${WORK} -P ${HERE}/check_${check}.cmake RESULT_VARIABLE code ERROR_VARIABLE said)
  if(code EQUAL 0)
    message(SEND_ERROR "check_${check} does not see in ${file}: ${line}")
  endif()
endfunction()

expect_report(layers include/scree/base/bad.hpp "#include \"scree/geometry/grid.hpp\"")
expect_report(layers src/geometry/bad.cpp "#include \"dynamics/engine.hpp\"")
expect_report(layers src/dynamics/bad.cpp "#include <gdal_priv.h>")
expect_report(layers src/ensemble/bad.cpp "#include \"gis/layers.hpp\"")
expect_report(layers src/ensemble/bad.hpp "#include \"scree/inference/gap.hpp\"")
expect_report(layers include/scree/base/bad.hpp "#include <tbb/parallel_for.h>")
expect_report(layers include/scree/base/bad.hpp "#include \"own.hpp\"")
expect_report(layers gis/bad.cpp "#include \"scree/dynamics/soil.hpp\"")
expect_report(layers gis/bad.hpp "#include <ogrsf_frmts.h>")
expect_report(layers gis/bad.hpp "  #  include <sqlite3.h>")
expect_report(layers gis/bad.cpp "#include \"cli/app.hpp\"")
expect_report(layers cli/bad.cpp "#include <proj.h>")
expect_report(layers cli/bad.hpp "#include <toml++/toml.h>")
expect_report(layers include/scree/bad.h "#include <gdal.h>")
expect_report(layers cli/bad.hpp "#include \"cli/json.hpp\"")
expect_report(layers tests/support/bad.cpp "#include \"cli/app.hpp\"")
expect_report(layers tests/unit/bad.cpp "#include \"cli/app.hpp\"")
expect_report(layers src/base/bad.cpp "#include <gtest/gtest.h>")
expect_report(layers gis/bad.cpp "#include \"geometry/facet_walk.hpp\"")
expect_report(layers gis/bad.hpp "#include \"src/geometry/facet_walk.hpp\"")
expect_report(layers cli/bad.cpp "#include \"dynamics/engine.hpp\"")
expect_report(layers cli/bad.cpp "#include \"../src/dynamics/engine.hpp\"")
foreach(field
    "double mass = 1.0;  ///< of the body"
    "Vec3 velocity = Vec3::Zero();"
    "std::vector<double> times;    ///< since release"
    "std::array<double, 2> ratio{0.5, 1.0};  ///< of the edges"
    "double limit = std::numeric_limits<double>::infinity();  ///< of the mass"
    "std::optional<double> height;  ///< of release"
    "std::vector<std::array<double, 3>> axes;  ///< per block"
    "Mat3 inertia = Mat3::Identity();  ///< in the body frame"
    "const double mass;  ///< of the body"
    "double from, to;  ///< of a stretch"
    "std::vector<std::vector<double>>\n        draws;  ///< per parameter"
    "struct T {\n        double mass;  ///< of the body\n    };")
  expect_report(units include/scree/base/bad.hpp "struct Bad {\n    ${field}\n};")
endforeach()
expect_report(units include/scree/bad.h "typedef struct bad {\n    double mass;  /* of the body */\n} bad;")
expect_report(tests tests/unit/forgotten_test.cpp "#include <gtest/gtest.h>")
expect_report(modules gis/bad.cpp "#include <string>")
expect_report(modules cli/bad.hpp "#include <string>")
expect_report(paths my-build-notes/bad.md "see /ho${folder}/scree")
expect_report(paths README.md "see /ho${folder}/scree")
expect_report(paths cli/bad.cpp "const char* kFile = \"/ho${folder}/dtm.tif\"")
file(REMOVE_RECURSE ${WORK})
