// A disc of 100 mm, in mm, with strips of 0.08 diameters at top and bottom: gmsh part.geo -2
R = 50; h = 1.5;
a = Asin(0.08);                           // half the angle of a strip
Point(1) = {0, 0, 0, h};
Point(2) = {R*Sin(a), R*Cos(a), 0, h};
Point(3) = {-R*Sin(a), R*Cos(a), 0, h};
Point(4) = {-R*Sin(a), -R*Cos(a), 0, h};
Point(5) = {R*Sin(a), -R*Cos(a), 0, h};
Point(6) = {-R, 0, 0, 2*h};
Point(7) = {R, 0, 0, 2*h};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 6};
Circle(3) = {6, 1, 4};
Circle(4) = {4, 1, 5};
Circle(5) = {5, 1, 7};
Circle(6) = {7, 1, 2};
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
Physical Surface("disc") = {1};
Physical Curve("top") = {1};
Physical Curve("bottom") = {4};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
