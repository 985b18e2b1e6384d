# Every field of a public header that holds a quantity says its unit in square brackets ([-] where it has none, [*] where it is
# that of what is stored), in its own comment or in the comment line right above.
# Fields are declarations inside a struct, class or union, by the indentation that clang-format gives them; seen are numbers, vectors and matrices with std::vector,
# std::array and std::optional around them. Not seen are whole numbers, maps and pairs, and names of other types for these (Grid<double>, Box2).
# Usage: cmake -DROOT=folder -P check_units.cmake
set(quantity "(const |mutable )*(std::(vector|array|optional)<)*(double|float|Vec[23]?|Spin|Mat[23]|typename Space<Dim>::(Vec|Spin)|Eigen::(Vector|Matrix|Array)Xd)(>|, [0-9a-zA-Z_:]+>)*")
set(name "[A-Za-z_0-9]+( =|,|{|<unit>|<end>)")  # of a function "(" comes next

file(GLOB_RECURSE headers RELATIVE ${ROOT} ${ROOT}/include/*.hpp ${ROOT}/include/*.h)
foreach(header IN LISTS headers)
  file(READ ${ROOT}/${header} text)
  # declarations that are broken over two lines
  string(REGEX REPLACE "(\n +[A-Za-z0-9_:<>, =]*([A-Za-z0-9_>=]|::))\n +([A-Za-z0-9_+.-])" "\\1 \\3" text "${text}")
  string(REPLACE "[" "<unit>" text "${text}")  # brackets and semicolons mean something else in lists
  string(REPLACE "]" "</unit>" text "${text}")
  string(REPLACE ";" "<end>" text "${text}")
  string(REPLACE "\n" ";" lines "${text}")
  set(indents)  # of the types around the line
  set(fields "none")
  set(above "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^( *)(typedef )?(struct|class|union)( .*)?{$")
      list(APPEND indents "${CMAKE_MATCH_1}|")
      set(fields "${CMAKE_MATCH_1}    ")
    elseif(indents AND line MATCHES "^( *)}( [a-z_0-9]+)?<end>")
      list(GET indents -1 last)
      if(last STREQUAL "${CMAKE_MATCH_1}|")
        list(POP_BACK indents)
        set(fields "none")
        if(indents)
          list(GET indents -1 last)
          string(REPLACE "|" "    " fields "${last}")
        endif()
      endif()
    elseif(line MATCHES "^${fields}${quantity} ${name}" AND NOT "${above}${line}" MATCHES "/[/*].*<unit>.+</unit>")
      string(REPLACE "<unit>" "[" line "${line}")
      string(REPLACE "</unit>" "]" line "${line}")
      string(REPLACE "<end>" "\;" line "${line}")
      message(SEND_ERROR "${header}: ${line}: the comment must state the unit in square brackets")
    endif()
    if(line MATCHES "^ *(//|/\\*)")
      set(above "${line}")
    else()
      set(above "")
    endif()
  endforeach()
endforeach()
