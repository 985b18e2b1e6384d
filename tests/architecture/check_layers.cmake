# Who may include whom. base <- geometry <- dynamics <- ensemble <- inference; gis sees base and geometry, never mechanics;
# cli sees all and is seen by its tests only; both see of the core what is public; third-party headers of gis stay in .cpp files.
# Usage: cmake -DROOT=folder -P check_layers.cmake
cmake_policy(SET CMP0057 NEW)

# forbid(REASON text IN globs INCLUDES regex [EXCEPT files]): no file of the globs may include what matches.
function(forbid)
  cmake_parse_arguments(ARG "" "REASON;INCLUDES" "IN;EXCEPT" ${ARGN})
  set(files)
  foreach(glob IN LISTS ARG_IN)
    file(GLOB_RECURSE found RELATIVE ${ROOT} ${ROOT}/${glob})
    list(APPEND files ${found})
  endforeach()
  foreach(file IN LISTS files)
    if(file IN_LIST ARG_EXCEPT)
      continue()
    endif()
    file(STRINGS ${ROOT}/${file} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"](${ARG_INCLUDES})")
    foreach(line IN LISTS lines)
      message(SEND_ERROR "${file}: ${line}: ${ARG_REASON}")
    endforeach()
  endforeach()
endfunction()

set(gis_libraries "gdal|ogr|cpl_|vrtdataset|proj\\.h|proj/|CGAL/|sqlite3|gmp|mpfr|boost/")
set(cli_libraries "CLI/|toml|nlohmann/")

# --- upwards in the core: headers include as scree/LAYER/..., sources also as LAYER/... ---
set(higher base geometry dynamics ensemble inference)
foreach(layer IN ITEMS base geometry dynamics ensemble)
  list(POP_FRONT higher)
  list(JOIN higher "|" names)
  forbid(REASON "${layer} must not see a layer above it" IN include/scree/${layer}/*.hpp src/${layer}/*.?pp INCLUDES "(scree/)?(${names})/")
endforeach()

# --- the core knows no files and no command line ---
forbid(REASON "the core must not see gis or cli" IN include/*.hpp src/*.?pp INCLUDES "(scree/)?(gis|cli)/")
forbid(REASON "the core must not see libraries of gis or cli" IN include/*.hpp src/*.?pp INCLUDES "${gis_libraries}|${cli_libraries}"
  EXCEPT src/geometry/convex_hull.cpp)

# --- public headers: std, Eigen and each other ---
file(GLOB_RECURSE headers RELATIVE ${ROOT} ${ROOT}/include/*.hpp ${ROOT}/include/*.h)
foreach(header IN LISTS headers)
  file(STRINGS ${ROOT}/${header} lines REGEX "^[ \t]*#[ \t]*include")
  foreach(line IN LISTS lines)
    if(NOT line MATCHES "include (<Eigen/[A-Za-z]+>|<[a-z_]+>|\"scree/[a-z_0-9/]+\\.h(pp)?\")")
      message(SEND_ERROR "${header}: ${line}: public headers include std, Eigen and scree only")
    endif()
  endforeach()
endforeach()

forbid(REASON "src must not see what only tests need" IN include/*.hpp src/*.?pp gis/*.?pp cli/*.?pp INCLUDES "gtest|gmock|benchmark/|tests/|support/")

forbid(REASON "what lies in src is the core's own: include scree/LAYER/..." IN gis/*.?pp cli/*.?pp INCLUDES "(\\.\\./)*src/|(base|geometry|dynamics|ensemble|inference)/")

# --- gis ---
forbid(REASON "gis must not know mechanics" IN gis/*.?pp INCLUDES "scree/(dynamics|ensemble|inference)/|cli/")
forbid(REASON "third-party headers of gis belong into .cpp files" IN gis/*.hpp INCLUDES "${gis_libraries}")

# --- cli: the same for its own libraries; the files of others go through gis ---
forbid(REASON "cli reads and writes files of others through gis" IN cli/*.?pp INCLUDES "${gis_libraries}")
forbid(REASON "third-party headers of cli belong into .cpp files" IN cli/*.hpp INCLUDES "${cli_libraries}" EXCEPT cli/json.hpp)
forbid(REASON "third-party headers of cli belong into .cpp files" IN cli/*.hpp INCLUDES "cli/json\\.hpp")

# --- nobody sees cli but its tests, and the benchmarks, which load a whole site ---
forbid(REASON "only tests of the program may see cli" IN tests/unit/*.?pp tests/verification/*.?pp tests/gis/*.?pp tests/support/*.?pp INCLUDES "cli/")
