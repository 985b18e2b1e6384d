# Every test that somebody wrote is built: a source that tests/CMakeLists.txt does not name tests nothing.
# Usage: cmake -DROOT=folder -P check_tests.cmake
file(READ ${ROOT}/tests/CMakeLists.txt built)
file(GLOB_RECURSE sources RELATIVE ${ROOT}/tests ${ROOT}/tests/*_test.cpp)
foreach(source IN LISTS sources)
  string(FIND "${built}" "${source}" at)
  if(at EQUAL -1)
    message(SEND_ERROR "tests/${source}: not in tests/CMakeLists.txt, so that it is never built")
  endif()
endforeach()
