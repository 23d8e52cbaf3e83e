// Two bars of 20 mm in height and a specimen of 20 x 16 mm between them, each with points of its own, in mm: gmsh part.geo -2
h = 0.7;                                  // size of elements in the specimen
Point(1) = {-10, -8, 0};
Point(2) = {10, -8, 0};
Point(3) = {10, 8, 0};
Point(4) = {-10, 8, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
For bar In {0:1}
  side = 2*bar - 1;                       // the first bar, the second one
  length = 500 - 100*bar;
  p = newp;
  Point(p) = {side*(10 + length), side*10, 0};
  Point(p + 1) = {side*10, side*10, 0};
  Point(p + 2) = {side*10, side*8, 0};
  Point(p + 3) = {side*10, -side*8, 0};
  Point(p + 4) = {side*10, -side*10, 0};
  Point(p + 5) = {side*(10 + length), -side*10, 0};
  c = newc;
  For i In {0:4}
    Line(c + i) = {p + i, p + i + 1};
  EndFor
  Line(c + 5) = {p + 5, p};
  l = newcl;
  Curve Loop(l) = {c : c + 5};
  s = news;
  Plane Surface(s) = {l};
  If (bar == 0)
    Physical Surface("incident") = {s};
    Physical Curve("struck") = {c + 5};
  Else
    Physical Surface("transmission") = {s};
  EndIf
EndFor
Physical Surface("specimen") = {1};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
Field[1] = MathEval;
Field[1].F = Sprintf("%g + (5 - %g)*Min(1, Max(0, (Abs(x) - 12)/28))", h, h);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
