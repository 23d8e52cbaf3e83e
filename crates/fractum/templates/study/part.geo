// A bar of 100 x 20 mm, in mm: gmsh part.geo -2
h = 2.5;                                  // size of elements
Point(1) = {-50, -10, 0, h};
Point(2) = {50, -10, 0, h};
Point(3) = {50, 10, 0, h};
Point(4) = {-50, 10, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Physical Surface("bar") = {1};
Physical Curve("right") = {2};
Physical Curve("left") = {4};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
