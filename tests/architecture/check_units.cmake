# Every field of a public header that holds a quantity says its unit in square brackets ([-] where it has none, [*] where it is
# that of what is stored), in its own comment or, for a group of declarations, in the comment line right above.
# Usage: cmake -DROOT=folder -P check_units.cmake
set(quantity "(double|float|Vec2|Vec3|std::array<double, [0-9a-zA-Z]+>|std::vector<(double|Vec2|Vec3)>)")

file(GLOB_RECURSE headers RELATIVE ${ROOT} ${ROOT}/include/*.hpp ${ROOT}/include/*.h)
foreach(header IN LISTS headers)
  file(READ ${ROOT}/${header} text)
  string(REPLACE "[" "<unit>" text "${text}")  # brackets and semicolons mean something else in lists
  string(REPLACE "]" "</unit>" text "${text}")
  string(REPLACE ";" "<end>" text "${text}")
  string(REPLACE "\n" ";" lines "${text}")
  foreach(line IN LISTS lines)
    # a declaration, not a function, a local variable or a constant: indented by exactly one level
    if(line MATCHES "^    ${quantity} [a-z_0-9]+(<unit>[^<]*</unit>)?( = [^(<]*|\\{[^<]*\\}| = [A-Za-z0-9:]+\\(\\))?<end>" AND NOT line MATCHES "/[/*].*<unit>.+</unit>")
      string(REPLACE "<unit>" "[" line "${line}")
      string(REPLACE "</unit>" "]" line "${line}")
      string(REPLACE "<end>" "\;" line "${line}")
      message(SEND_ERROR "${header}: ${line}: the comment must state the unit in square brackets")
    endif()
  endforeach()
endforeach()
