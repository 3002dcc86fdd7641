# SPDX-License-Identifier: Apache-2.0
# What Doxygen 1.9.4 takes for markup of its own, and C++ that it does not follow (docs/Doxyfile).
# Code spans of one sign that is a command of Doxygen's.
s/`\.`/dot/g
s/`\.\.`/two dots/g
s/`\.\*`/dot and star/g
s/`%`/"%%"/g
s/`#`/"\\#"/g
s/`\. \* + ? ( ) \[ \] { } | ^ \$`/dots, stars, plus and question marks, brackets, bars, carets and dollars/
s/`\\Q`/"\\\\Q"/g
/^ *\/\/\//s/#include/include/
# A specialisation in another namespace than that of the file.
/^struct std::hash</,/^};/d
# Templates that are defined behind their class.
/^template <typename T>$/{
N
/\nconst T[*&] Type::/{
:more
N
/\n}$/!b more
d
}
}
