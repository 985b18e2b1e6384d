# No file of the project names a folder of the machine that it was written on.
# Usage: cmake -DROOT=folder -P check_paths.cmake
file(GLOB_RECURSE files RELATIVE ${ROOT} LIST_DIRECTORIES false ${ROOT}/*.cpp ${ROOT}/*.hpp ${ROOT}/*.c ${ROOT}/*.h ${ROOT}/*.txt ${ROOT}/*.cmake ${ROOT}/*.json
  ${ROOT}/*.md ${ROOT}/*.py ${ROOT}/*.sh ${ROOT}/*.toml ${ROOT}/*.csv ${ROOT}/.ci/* ${ROOT}/.clang-* ${ROOT}/.gitignore)
foreach(file IN LISTS files)
  if(file MATCHES "^build/|^\\.git/|/out[^/]*/")
    continue()
  endif()
  file(STRINGS ${ROOT}/${file} lines REGEX "(^|[^A-Za-z0-9_.~/])/(home|root|work|tmp|Users|mnt|opt|srv|workspace)/[A-Za-z0-9_.]")
  foreach(line IN LISTS lines)
    message(SEND_ERROR "${file}: ${line}: names a folder of one machine")
  endforeach()
endforeach()
