// A beam of 400 x 100 mm with a notch of 30 x 4 mm, in mm: gmsh part.geo -2
L = 400; H = 100; s = 150;                // length, height, half the span
h = 12; f = 3;                            // size of elements, and where the crack goes
Point(1) = {-L/2, 0, 0, h};
Point(2) = {-s, 0, 0, h};
Point(3) = {-2, 0, 0, f};
Point(4) = {-2, 30, 0, f};
Point(5) = {2, 30, 0, f};
Point(6) = {2, 0, 0, f};
Point(7) = {s, 0, 0, h};
Point(8) = {L/2, 0, 0, h};
Point(9) = {L/2, H, 0, h};
Point(10) = {4, H, 0, f};
Point(11) = {-4, H, 0, f};
Point(12) = {-L/2, H, 0, h};
For i In {1:11}
  Line(i) = {i, i+1};
EndFor
Line(12) = {12, 1};
Curve Loop(1) = {1:12};
Plane Surface(1) = {1};
Physical Surface("beam") = {1};
Physical Point("left") = {2};
Physical Point("right") = {7};
Physical Curve("nose") = {10};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
