// A notched beam of 200 x 50 mm with thirteen round grains in its middle, in mm: gmsh part.geo -2
SetFactory("OpenCASCADE");
Rectangle(1) = {-100, 0, 0, 200, 50};
Rectangle(2) = {-1.5, 0, 0, 3, 15};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
Disk(11) = {-27, 9, 0, 5};
Disk(12) = {-13, 9, 0, 6};
Disk(13) = {13, 9, 0, 5.5};
Disk(14) = {26, 9, 0, 4.5};
Disk(15) = {-22, 25, 0, 5.5};
Disk(16) = {-6, 23.5, 0, 4.5};
Disk(17) = {6.5, 25, 0, 4};
Disk(18) = {20, 23, 0, 5.5};
Disk(19) = {-28, 41, 0, 4.5};
Disk(20) = {-13, 40, 0, 5};
Disk(21) = {1, 38, 0, 5.5};
Disk(22) = {15, 40, 0, 5};
Disk(23) = {29, 38, 0, 4.5};
Point(1001) = {-80, 0, 0};
Point(1002) = {80, 0, 0};
Point(1003) = {-2, 50, 0};
Point(1004) = {2, 50, 0};
BooleanFragments{ Surface{3}; Delete; }{ Surface{11:23}; Point{1001:1004}; Delete; }
Physical Surface("aggregate") = {11:23};
all() = Surface{:};
all() -= {11:23};
Physical Surface("mortar") = all();
Physical Point("left") = Point In BoundingBox {-80.1, -0.1, -1, -79.9, 0.1, 1};
Physical Point("right") = Point In BoundingBox {79.9, -0.1, -1, 80.1, 0.1, 1};
Physical Curve("nose") = Curve In BoundingBox {-2.1, 49.9, -1, 2.1, 50.1, 1};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
Field[1] = MathEval;
Field[1].F = "1.3 + 0.2*Max(0, Abs(x) - 36)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
