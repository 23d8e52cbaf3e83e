// Two halves of a sheared joint, each 100 x 25 mm, in mm: gmsh part.geo -2
h = 4;                                    // size of elements
For half In {0:1}
  p = newp;
  Point(p) = {0, 25 * half, 0, h};
  Point(p + 1) = {100, 25 * half, 0, h};
  Point(p + 2) = {100, 25 * half + 25, 0, h};
  Point(p + 3) = {0, 25 * half + 25, 0, h};
  c = newc;
  Line(c) = {p, p + 1};
  Line(c + 1) = {p + 1, p + 2};
  Line(c + 2) = {p + 2, p + 3};
  Line(c + 3) = {p + 3, p};
  l = newcl;
  Curve Loop(l) = {c : c + 3};
  s = news;
  Plane Surface(s) = {l};
  If (half == 0)
    Physical Surface("lower") = {s};
    Physical Curve("bottom") = {c};
  Else
    Physical Surface("upper") = {s};
    Physical Curve("top") = {c + 2};
  EndIf
EndFor
