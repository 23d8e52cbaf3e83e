// Strip of a plate, 6 mm along its cooled face and 4 mm deep, in mm: gmsh part.geo -2
h = 0.07;                                 // size of elements
Point(1) = {0, 0, 0, h};
Point(2) = {6, 0, 0, h};
Point(3) = {6, 4, 0, h};
Point(4) = {0, 4, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Surface("plate") = {1};
Physical Curve("middle") = {1};
Physical Curve("cooled") = {3};
Physical Curve("left") = {4};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
